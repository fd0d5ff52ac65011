"""Closed forms: what the slides' integrals and variances come to where they are known. Ground truth, no kernels.

- `irradiance`: polygons, disks, spheres, skies, lights without area
- `phong`: the lobe of the modified Phong model under a sky or a polygon
- `glossy`: the jitters of "Creating glossy reflections" that are not Phong, under a sky
- `variances`: exact variances of one sample of an estimator
"""
