/* The same rays as a render, traced by bare single-ray calls from a C loop: the speed that raylab is measured by. */
#include <stdint.h>
#include <string.h>

struct Ray { float org[3], tnear, dir[3], time, tfar; uint32_t mask, id, flags; } __attribute__((aligned(16)));
struct RayHit { struct Ray ray; float hit[5]; uint32_t prim, geom, inst, inst_prim; } __attribute__((aligned(16)));
typedef void (*Call)(void *, void *, void *);

/* rays: n x 2 x 8 floats (origin, tnear, direction, tfar): a camera ray and its shadow ray (tfar < 0: none). */
int64_t trace_all(void *intersect1, void *occluded1, void *scene, const float *rays, int64_t n)
{
    int64_t lit = 0;
    for (int64_t i = 0; i < n; ++i) {
        const float *r = rays + 16 * i;
        struct RayHit h;
        memcpy(h.ray.org, r, 12); h.ray.tnear = r[3];
        memcpy(h.ray.dir, r + 4, 12); h.ray.tfar = r[7];
        h.ray.time = 0; h.ray.mask = ~0u; h.ray.id = 0; h.ray.flags = 0;
        h.geom = h.prim = h.inst = h.inst_prim = ~0u;
        ((Call)intersect1)(scene, &h, 0);
        r += 8;
        if (r[7] < 0) continue;
        struct Ray s;
        memcpy(s.org, r, 12); s.tnear = r[3];
        memcpy(s.dir, r + 4, 12); s.tfar = r[7];
        s.time = 0; s.mask = ~0u; s.id = 0; s.flags = 0;
        ((Call)occluded1)(scene, &s, 0);
        lit += s.tfar > 0;
    }
    return lit;
}
