"""The slide table: every slide of the lecture, in order: the functions that mirror it, a scene, a figure and a test.

`docs/slides.md` is this table as a page; a test keeps the two equal and the table complete.
"""

from __future__ import annotations

from typing import NamedTuple


class Slide(NamedTuple):
    """A slide: its title (told apart where several slides share it), its functions, and what to know about them.

    `scene` is a folder of reference_scenes, `figure` a name of `raylab figures`, `test` a file::name in tests.
    """

    title: str
    functions: tuple[str, ...]
    note: str = ""
    scene: str = ""
    figure: str = ""
    test: str = ""


NOT_YET = "not in this version"

TABLE = (
    Slide("Advanced Ray Tracing", (), "title slide"),
    Slide(
        "Basic ray tracing",
        ("raylab.basic.basic", "raylab.shade.point_light", "raylab.fresnel.dielectric"),
        "the recursion is raylab.basic.radiance",
        scene="mirror_balls",
        figure="basic_depth",
        test="test_basic.py::test_one_shadow_ray_for_every_point_light",
    ),
    Slide(
        "Basic ray traced image",
        ("raylab.basic.basic", "raylab.samplers.Centre"),
        "one ray through the centre of each pixel",
        scene="mirror_balls",
        figure="basic_image",
        test="test_basic.py::test_glass_ball_turns_the_world_upside_down",
    ),
    Slide(
        "Discontinuities in basic RT",
        ("raylab.basic.basic",),
        "five figures: each discontinuity beside its cure; without mirrors: reference_scenes/basic_ray_tracing",
        scene="mirror_balls",
        figure="discontinuity_edges",
        test="test_basic.py::test_an_area_light_is_a_point_light_in_its_middle",
    ),
    Slide(
        "Soft shadows",
        ("raylab.shade.area_diffuse",),
        scene="soft_shadows",
        figure="soft_shadow",
        test="test_closed_form_renders.py::test_area_lights",
    ),
    Slide(
        "Cause of soft shadows (point lights)",
        ("raylab.shade.point_light",),
        scene="basic_ray_tracing",
        figure="hard_shadow",
        test="test_closed_form_renders.py::test_a_blocker_takes_lights_without_area_away",
    ),
    Slide(
        "Cause of soft shadows (area lights)",
        ("raylab.shade.area_diffuse",),
        scene="soft_shadows",
        figure="soft_shadow_sizes",
        test="test_closed_form_renders.py::test_variance_of_a_rectangle",
    ),
    Slide(
        "Glossy reflection",
        ("raylab.brdf.Phong", "raylab.rough.RoughConductor"),
        "picture",
        scene="veach_plates",
        figure="roughness",
        test="test_closed_form_renders.py::test_phong_under_a_polygon",
    ),
    Slide(
        "Cause of glossy reflection (smooth surfaces)",
        ("raylab.smooth.Conductor",),
        "one direction in, one out",
        scene="mirror_balls",
        figure="discontinuity_mirrors",
        test="test_rough.py::test_a_nearly_smooth_surface_reflects_like_a_mirror",
    ),
    Slide(
        "Cause of glossy reflection (rough surfaces)",
        ("raylab.microfacet.Microfacets", "raylab.rough.RoughConductor", "raylab.rough.RoughPlastic"),
        "many small mirrors; seen normals are sampled",
        scene="veach_plates",
        figure="roughness",
        test="test_microfacet.py::test_what_is_seen_is_the_projected_area_of_the_visible_facets",
    ),
    Slide(
        "Depth of field",
        ("raylab.camera.ThinLens",),
        "picture",
        scene="depth_of_field",
        figure="depth_of_field",
        test="test_depth_of_field.py::test_a_picture_out_of_focus_is_the_closed_form_in_each_pixel",
    ),
    Slide(
        "Cause of focusing effects (lenses)",
        ("raylab.camera.ThinLens",),
        "all rays of a point of the focus plane meet",
        scene="depth_of_field",
        figure="depth_of_field",
        test="test_depth_of_field.py::test_all_rays_of_a_film_point_meet_on_the_focus_plane",
    ),
    Slide(
        "Cause of focusing effects (point aperture)",
        ("raylab.camera.Pinhole",),
        scene="depth_of_field",
        figure="depth_of_field",
        test="test_bitwise_relations.py::test_a_point_aperture_is_the_pinhole",
    ),
    Slide(
        "Cause of focusing effects (finite aperture)",
        ("raylab.camera.ThinLens", "raylab.camera.DiskAperture"),
        scene="depth_of_field",
        figure="depth_of_field",
        test="test_depth_of_field.py::test_a_picture_out_of_focus_is_the_closed_form_in_each_pixel",
    ),
    Slide(
        "Motion blur",
        ("raylab.motion.Moving",),
        "picture",
        scene="motion_blur",
        figure="motion_blur",
        test="test_bitwise_relations.py::test_a_closed_shutter_is_the_static_picture",
    ),
    Slide(
        "Cause of motion blur",
        ("raylab.motion.Moving", "raylab.keyframes.matrix_at"),
        scene="motion_blur",
        figure="motion_blur",
        test="test_motion_blur.py::test_a_moving_edge_covers_a_pixel_as_the_formula_says",
    ),
    Slide(
        "Creating soft shadows",
        ("raylab.lights.RectangleShape", "raylab.samplers.make", "raylab.solid_angle.sample_rectangle_angle"),
        "uniform in square; also soft_shadow_points, area_or_solid_angle in the gallery",
        scene="soft_shadows",
        figure="soft_shadow_variance",
        test="test_samplers.py::test_the_variance_of_a_latin_hypercube",
    ),
    Slide(
        "Illumination as integration (Lambertian, over the light)",
        (
            "raylab.shade.point_light",
            "raylab.ladders.point_source",
            "raylab.ladders.small_area_source",
            "raylab.ladders.area_sources",
            "raylab.ladders.area_source",
        ),
        "steps 1 to 4; f_r is the number k_d",
        scene="soft_shadows",
        figure="ladder_area_diffuse",
        test="test_ladders.py::test_step_3_over_the_light_tends_to_step_4_with_order_1",
    ),
    Slide(
        "Area source by Monte Carlo (integral, diffuse)",
        ("raylab.shade.area_diffuse",),
        scene="soft_shadows",
        figure="mc_area_diffuse",
        test="test_closed_form_renders.py::test_variance_of_a_rectangle",
    ),
    Slide(
        "Area source by Monte Carlo (diffuse)",
        ("raylab.shade.area_diffuse",),
        scene="cornell_box",
        figure="mc_cornell_box",
        test="test_closed_form_renders.py::test_area_lights",
    ),
    Slide(
        "Illumination as integration (any BRDF, over the light)",
        (
            "raylab.shade.point_light",
            "raylab.ladders.point_source",
            "raylab.ladders.small_area_source",
            "raylab.ladders.area_sources",
            "raylab.ladders.area_source",
        ),
        "steps 1 to 4",
        scene="veach_plates",
        figure="ladder_area_brdf",
        test="test_ladders.py::test_step_4_over_the_light_is_the_closed_form",
    ),
    Slide(
        "Area source by Monte Carlo (integral, any BRDF)",
        ("raylab.shade.area",),
        scene="veach_plates",
        figure="mc_area_brdf",
        test="test_closed_form_renders.py::test_phong_under_a_polygon",
    ),
    Slide(
        "Area source by Monte Carlo",
        ("raylab.shade.area", "raylab.shade.area_solid_angle"),
        scene="veach_plates",
        figure="mc_plates",
        test="test_closed_form_renders.py::test_light_sampling_and_both_agree_on_a_glossy_surface",
    ),
    Slide(
        "Illumination as integration (Lambertian, over directions)",
        (
            "raylab.shade.directional_light",
            "raylab.ladders.directional_source",
            "raylab.ladders.small_solid_angle",
            "raylab.ladders.solid_angles",
            "raylab.ladders.environment",
        ),
        "steps 1 to 4; f_r is the number k_d",
        scene="ball_under_sky",
        figure="ladder_directions_diffuse",
        test="test_ladders.py::test_step_3_over_directions_tends_to_step_4_with_order_1",
    ),
    Slide(
        "Diffuse surface in env. by Monte Carlo (integral)",
        ("raylab.sampling.pdf_hemisphere", "raylab.sampling.pdf_cos_hemisphere"),
        scene="ball_under_sky",
        figure="mc_sky_densities",
        test="test_closed_form_skies.py::test_variance_under_a_sky",
    ),
    Slide(
        "Diffuse surface in env. by Monte Carlo",
        ("raylab.shade.env_uniform", "raylab.shade.env_cosine"),
        scene="ball_under_sky",
        figure="mc_ball_under_sky",
        test="test_closed_form_skies.py::test_gradient_sky",
    ),
    Slide(
        "Illumination as integration (any BRDF, over directions)",
        (
            "raylab.shade.directional_light",
            "raylab.ladders.directional_source",
            "raylab.ladders.small_solid_angle",
            "raylab.ladders.solid_angles",
            "raylab.ladders.environment",
        ),
        "steps 1 to 4",
        scene="hdr_sky",
        figure="ladder_directions_brdf",
        test="test_ladders.py::test_step_4_over_directions_is_the_closed_form",
    ),
    Slide(
        "Arbitrary surface in env. by Monte Carlo (integral)",
        ("raylab.brdf.Phong", "raylab.environment.ImageEnvironment"),
        "p proportional to the BRDF, and to the brightness",
        scene="hdr_sky",
        figure="mc_lobe_densities",
        test="test_closed_form_skies.py::test_variance_of_a_lobe_of_exponent_20",
    ),
    Slide(
        "Arbitrary surface in env. by Monte Carlo",
        ("raylab.shade.env_brightness", "raylab.shade.env_brdf"),
        "the captions of the two boxes are swapped on the slide",
        scene="hdr_sky",
        figure="errata_captions",
        test="test_closed_form_skies.py::test_image_sky",
    ),
    Slide(
        "Creating glossy reflections",
        ("raylab.glossy.glossy_jitter", "raylab.glossy.glossy_phong", "raylab.glossy.glossy_normal"),
        "which BRDF each has stands in raylab.glossy",
        scene="veach_plates",
        figure="glossy_lobes",
        test="test_glossy.py::test_phong_under_a_triangle",
    ),
    Slide(
        "Depth of field (eye rays)",
        ("raylab.camera.ThinLens", "raylab.camera.PolygonAperture"),
        scene="depth_of_field",
        figure="depth_of_field",
        test="test_depth_of_field.py::test_depth_of_field_blurs_an_edge_as_the_formula_says",
    ),
    Slide(
        "Motion blur (time)",
        ("raylab.motion.Moving", "raylab.pose.pose_at", "raylab.camera.MovingCamera"),
        "the clock of `scene.motion` is time; strobing: a shutter that opens and closes at once",
        scene="motion_blur",
        figure="blur_convergence",
        test="test_motion_blur.py::test_moving_lights_of_every_kind_light_as_they_stand",
    ),
    Slide("The Blue Umbrella", (), "picture"),
    Slide(
        "After the last slide (by light or by BRDF?)",
        ("raylab.beyond.mis_balance", "raylab.beyond.mis_power", "raylab.mis.balance", "raylab.mis.power"),
        "by both: multiple importance sampling combines them",
        scene="veach_plates",
        figure="light_or_brdf",
        test="test_mis.py::test_neither_technique_alone_is_safe_but_both_together_are",
    ),
    Slide(
        "After the last slide (many lights)",
        ("raylab.beyond.one_light_uniform", "raylab.beyond.one_light_power", "raylab.light_choice.alias_table"),
        "one light for all",
        scene="many_lights",
        figure="many_lights",
        test="test_mis.py::test_variance_of_one_light_of_two",
    ),
)


def markdown() -> str:
    """The table as docs/slides.md shows it."""
    lines = ["| slide | function | scene | figure | test | note |", "|---|---|---|---|---|---|"]
    for slide in TABLE:
        functions = ", ".join(f"`{name}`" for name in slide.functions) or "-"
        figure = f"[{slide.figure}](figures/{slide.figure}.png)" if slide.figure else "-"
        scene, test = (f"`{name}`" if name else "-" for name in (slide.scene, slide.test))
        lines.append(f"| {slide.title} | {functions} | {scene} | {figure} | {test} | {slide.note} |")
    return "\n".join(lines)
