"""Scene files with one mistake each: the line on which it stands and what the message about it must name."""

# ruff: noqa: E501 (the rows of the tables are XML)

from __future__ import annotations

SENSOR = '<sensor type="perspective"/>'


def to_world(operation: str, kind: str = "rectangle") -> str:
    return f'<shape type="{kind}"><transform name="to_world">\n{operation}</transform></shape>'


def diffuse(reflectance: str) -> str:
    return f'<bsdf type="diffuse">\n{reflectance}</bsdf>'


def conductor(inside: str) -> str:
    return f'<bsdf type="conductor">\n{inside}</bsdf>'


def dielectric(inside: str) -> str:
    return f'<bsdf type="dielectric">\n{inside}</bsdf>'


def film(inside: str) -> str:
    return f'<sensor type="perspective"><film type="hdrfilm">\n{inside}</film></sensor>'


def texture(inside: str, filename: str = "half.exr") -> str:
    return f'<texture type="bitmap"><string name="filename" value="{filename}"/>\n{inside}</texture>'


def key(time: float | str, operation: str = "") -> str:
    return f'<transform time="{time}">{operation}</transform>'


def animated(*keys: str, kind: str = 'shape type="rectangle"') -> str:
    """The keyframes start in the line after that of the <animation>, one to a line."""
    return f'<{kind}><animation name="to_world">\n' + "\n".join(keys) + f"</animation></{kind.split()[0]}>"


def thin_lens(*floats: str) -> str:
    values = "\n".join(f'<{kind} name="{name}" value="{value}"/>' for kind, name, value in map(str.split, floats))
    return f'<sensor type="thinlens">\n{values}</sensor>'


def document(body: str) -> str:
    """The file with `body` from its second line on; it has a sensor."""
    sensor = "" if body.startswith("<sensor") else SENSOR
    return f'<scene version="3.0.0">\n{body}\n{sensor}</scene>'


# The body starts in line 2 of the file: `line` counts from there. Then what the message must name.
CASES = [
    # unknown words
    (2, '<shape type="rectangel"/>', '<shape type="rectangel">: unknown shape', 'did you mean "rectangle"?'),
    (2, '<shape type="hair"/>', "raylab supports cube, cylinder, disk, obj, ply, rectangle, sphere"),
    (2, '<bsdf type="conducter"/>', '<bsdf type="conducter">: unknown bsdf', "diffuse, phong", "twosided", 'did you mean "conductor"?'),
    (2, '<emitter type="directionel"/>', 'did you mean "directional"?'),
    (2, '<texture type="checkerboard"/>', "unknown texture", "bitmap"),
    (2, '<sensor type="orthographic"/>', "unknown sensor", "perspective", "thinlens"),
    (2, '<sensor type="perspective"><film type="specfilm"/></sensor>', '<film type="specfilm">: unknown film'),
    (2, '<sensor type="perspective"><sampler type="sobol"/></sensor>', "unknown sampler", "ldsampler"),
    (3, film('<rfilter type="mitchell"/>'), "unknown rfilter", "box, gaussian, tent"),
    (2, '<integrator type="pahtt"/>', "unknown integrator", "path"),
    (3, diffuse('<spectrum type="regular" name="reflectance"/>'), "unknown spectrum", "blackbody, d65, srgb, uniform"),
    (2, '<shpae type="sphere"/>', "<shpae", "unknown element", 'did you mean "shape"?'),
    (2, '<medium type="homogeneous"/>', "does not support this element"),
    (2, '<shape type="sphere"><float name="radiuss" value="1"/></shape>', 'no parameter "radiuss"', '"radius"?'),
    (2, '<emitter type="point"><rgb name="radiance" value="1"/></emitter>', 'no parameter "radiance"', "intensity"),
    (2, '<shape type="disk"><boolean name="face_normals" value="true"/></shape>', 'no parameter "face_normals"'),
    (2, '<float name="foo" value="3"/>', '<float name="foo">', 'no parameter "foo"'),
    (2, '<shape type="sphere" to_world="1"/>', 'unknown attribute "to_world"', "expected id, name, type"),
    (2, '<shape type="sphere"><float name="radius" valeu="1"/></shape>', 'unknown attribute "valeu"', '"value"?'),
    (3, to_world('<rotat angle="1"/>'), "<rotat>: unknown transform", 'did you mean "rotate"?'),
    (3, texture('<string name="wrap_mode" value="repeet"/>'), 'unknown wrap_mode "repeet"', '"repeat"?'),
    (3, texture('<string name="filter_type" value="cubic"/>'), 'unknown filter_type "cubic"'),
    (3, film('<string name="pixel_format" value="rbg"/>'), 'unknown pixel_format "rbg"', '"rgb"?'),
    (
        3,
        '<sensor type="perspective"><float name="fov" value="9"/>\n<string name="fov_axis" value="z"/></sensor>',
        'unknown fov_axis "z"',
    ),
    # things in the wrong place, or too many, or too few
    (2, "<shape/>", '<shape>: attribute "type" is missing'),
    (2, '<shape type="sphere"><float name="radius"/></shape>', 'attribute "value" is missing'),
    (2, '<shape type="obj"/>', '<shape type="obj">: <string name="filename"> is missing'),
    (3, diffuse('<spectrum type="blackbody" name="reflectance"/>'), "emitters only"),
    (2, '<bsdf type="twosided"/>', "is missing"),
    # mirrors and glass
    (3, conductor('<string name="material" value="Gold"/>'), 'unknown material "Gold"', "Au", "none"),
    (3, conductor('<rgb name="k" value="3,2,1"/>'), '"k" is given but "eta" is not', "needs both"),
    (3, conductor('<float name="eta" value="1.5"/>'), '"eta" is given but "k" is not', "needs both"),
    (4, conductor('<rgb name="eta" value="1"/><rgb name="k" value="3"/>\n<string name="material" value="Au"/>'),
     'give either "material" or "eta" and "k"'),
    (3, conductor('<rgb name="eta" value="1,-1,1"/><rgb name="k" value="3"/>'), '"eta" must not be negative', "(1, -1, 1)"),
    (3, conductor('<rgb name="eta" value="1"/><string name="k" value="3"/>'), "<string", "must be given as <rgb>"),
    (3, conductor('<spectrum type="d65" name="eta"/><rgb name="k" value="3"/>'), "a number, a colour or a table"),
    (3, conductor('<rgb name="specular_reflectance" value="2"/>'), "a reflectance must lie in [0, 1]"),
    (3, conductor('<float name="alpha" value="0.1"/>'), 'no parameter "alpha"'),
    (3, dielectric('<float name="int_ior" value="0"/>'), '"int_ior" must be greater than 0', "got 0"),
    (3, dielectric('<float name="ext_ior" value="-1.3"/>'), '"ext_ior" must be greater than 0', "got -1.3"),
    (3, dielectric('<string name="int_ior" value="watr"/>'), 'unknown material "watr"', 'did you mean "water"?'),
    (3, dielectric('<rgb name="int_ior" value="1.5"/>'), "must be given as <float> or <integer> or <string>"),
    (3, dielectric('<rgb name="specular_transmittance" value="-1"/>'), "must lie in [0, 1]"),
    (3, '<bsdf type="twosided">\n<bsdf type="dielectric"/></bsdf>', "lets light through"),
    (3, '<integrator type="path">\n<integer name="max_depth" value="0"/></integrator>', '"max_depth" must be at least 1', "got 0"),
    (3, '<integrator type="path">\n<integer name="max_depth" value="-2"/></integrator>', '"max_depth" must be from -1', "got -2"),
    (3, '<integrator type="path">\n<float name="max_depth" value="3"/></integrator>', '"max_depth" must be given as <integer>'),
    (3, '<bsdf type="twosided">\n' + 3 * '<bsdf type="diffuse"/>' + "</bsdf>", "takes 2 <bsdf> at most"),
    (2, '<shape type="disk">' + 2 * '<bsdf type="diffuse"/>' + "</shape>", "takes 1 <bsdf> at most"),
    (2, '<shape type="disk">' + 2 * '<emitter type="area"/>' + "</shape>", "takes 1 <emitter> at most"),
    (2, '<shape type="disk"><emitter type="point"/></shape>', "only an area light can be inside a shape"),
    (2, '<shape type="disk"><film type="hdrfilm"/></shape>', '<film> has no place in <shape type="disk">'),
    (2, '<emitter type="area"/>', "an area light belongs inside a <shape>"),
    (3, '<emitter type="constant"/>\n<emitter type="constant"/>', "only one environment"),
    (3, '<integrator type="direct"/>\n<integrator type="direct"/>', "takes 1 <integrator> at most"),
    (2, '<sampler type="independent"/>', "<sampler> belongs inside <sensor>"),
    (2, '<rfilter type="box"/>', "<rfilter> belongs inside <film>"),
    (2, '<translate x="1"/>', "<translate>"),
    (2, '<shape type="disk"><float name="radius" value="1"><float name="a" value="1"/></float></shape>', "no nested"),
    (
        3,
        '<shape type="sphere"><float name="radius" value="1"/>\n<float name="radius" value="1"/></shape>',
        '"radius" is given twice',
        "line 2",
    ),
    (2, '<emitter type="area"><transform name="to_world"/></emitter>', "remove to_world"),
    (
        2,
        '<emitter type="point"><point name="position" value="1"/><transform name="to_world"/></emitter>',
        'either "position" or "to_world"',
    ),
    (2, '<sensor type="perspective"><string name="fov_axis" value="x"/></sensor>', '"fov" is missing'),
    (
        2,
        '<sensor type="perspective"><float name="fov" value="9"/><string name="focal_length" value="9mm"/></sensor>',
        'either "fov" or "focal_length"',
    ),
    (2, '<sensor type="perspective"><string name="focal_length" value="long"/></sensor>', '"50mm"', '"long"'),
    (3, film('<integer name="crop_width" value="3"/>'), "crop windows"),
    (2, '<sensor type="perspective"><sampler type="stratified"><boolean name="jitter" value="false"/></sampler></sensor>',
     "jitter"),
    # wrong types and bad numbers
    (2, '<shape type="sphere"><string name="radius" value="1"/></shape>', "<float> or <integer>, not as <string>"),
    (3, film('<float name="width" value="20"/>'), '"width" must be given as <integer>, not as <float>'),
    (3, diffuse('<string name="reflectance" value="1"/>'), "not as <string>"),
    (3, diffuse('<bsdf name="reflectance" type="diffuse"/>'), "must be a colour or a texture, not <bsdf>"),
    (2, '<shape type="sphere"><float name="radius" value="1e3x"/></shape>', 'expected a number, got "1e3x"'),
    (2, '<shape type="sphere"><float name="radius" value="0x10"/></shape>', 'expected a number, got "0x10"'),
    (2, '<shape type="sphere"><float name="radius" value="nan"/></shape>', 'expected a finite number, got "nan"'),
    (2, '<shape type="sphere"><float name="radius" value="-inf"/></shape>', 'expected a finite number, got "-inf"'),
    (2, '<shape type="sphere"><float name="radius" value="1e999"/></shape>', "expected a finite number", "1e999"),
    (2, '<shape type="sphere"><float name="radius" value=""/></shape>', 'expected a number, got ""'),
    (2, '<shape type="sphere"><float name="" value="1"/></shape>', "must not be empty"),
    (2, '<shape type="sphere"><point name="center" x="1" y="2"/></shape>', "z missing"),
    (2, '<shape type="sphere"><point name="center" value="1 2"/></shape>', "expected 1 or 3 numbers, got 2"),
    (2, '<shape type="sphere"><point name="center" value="1" x="1"/></shape>', "not both"),
    (2, '<shape type="sphere"><boolean name="flip_normals" value="1"/></shape>', 'expected "true" or "false", got "1"'),
    (3, film('<integer name="width" value="20.5"/>'), 'expected a whole number, got "20.5"'),
    (3, diffuse('<rgb name="reflectance" value="1 2"/>'), "expected 1 or 3 numbers, got 2"),
    (3, diffuse('<srgb name="reflectance" value="#ff88"/>'), '"#rrggbb"'),
    (3, diffuse('<srgb name="reflectance" value="255 0 0"/>'), "sRGB values must lie in [0, 1]"),
    (3, diffuse('<spectrum name="reflectance"/>'), "either value or filename"),
    (3, diffuse('<spectrum name="reflectance" value="400:0.1 500"/>'), "a wavelength and a value", '"500"'),
    (3, diffuse('<spectrum name="reflectance" value="500:0.1 400:0.2"/>'), "wavelengths must increase"),
    # values that make no sense
    (2, '<shape type="sphere"><float name="radius" value="0"/></shape>', '"radius" must be greater than 0, got 0'),
    (2, '<shape type="cylinder"><float name="radius" value="-1"/></shape>', '"radius" must be greater than 0, got -1'),
    (2, '<shape type="cylinder"><point name="p1" value="0"/></shape>', "must not be the same point"),
    (2, '<sensor type="perspective"><float name="fov" value="180"/></sensor>', '"fov" must be', "less than 180, got 180"),
    (2, '<sensor type="perspective"><float name="fov" value="0"/></sensor>', '"fov" must be greater than 0'),
    (2, '<sensor type="perspective"><float name="near_clip" value="0"/></sensor>', '"near_clip"'),
    (2, '<sensor type="perspective"><float name="far_clip" value="0.001"/></sensor>', '"far_clip"', "0.01"),
    (3, film('<integer name="width" value="0"/>'), '"width" must be from 1'),
    (3, film('<rfilter type="gaussian"><float name="stddev" value="0"/></rfilter>'), '"stddev"'),
    (2, '<sensor type="perspective"><sampler type="independent"><integer name="sample_count" value="0"/></sampler></sensor>',
     '"sample_count" must be from 1'),
    (3, diffuse('<rgb name="reflectance" value="0.5 1.2 0"/>'), "a reflectance must lie in [0, 1]", "(0.5, 1.2, 0)"),
    (3, diffuse('<float name="reflectance" value="-0.1"/>'), "a reflectance must lie in [0, 1]", "-0.1"),
    (3, diffuse('<spectrum name="reflectance" value="1.5"/>'), "a reflectance must lie in [0, 1]"),
    (3, diffuse('<spectrum name="reflectance" value="400:0.5 500:1.5"/>'), "must lie in [0, 1], got 1.5 at 500 nm"),
    (2, '<bsdf type="phong"><float name="exponent" value="-2"/></bsdf>', '"exponent" must not be negative, got -2'),
    (2, '<emitter type="point"><rgb name="intensity" value="1 -2 3"/></emitter>', "must not be negative", "(1, -2, 3)"),
    (2, '<emitter type="point"><spectrum name="intensity" value="400:1 500:-1"/></emitter>', "-1 at 500 nm"),
    (3, '<emitter type="envmap"><string name="filename" value="sky.exr"/>\n<float name="scale" value="-1"/></emitter>',
     '"scale" must not be negative'),
    (2, '<emitter type="directional"><vector name="direction" value="0"/></emitter>', "must not be zero"),
    (2, '<emitter type="point"><spectrum type="blackbody" name="intensity"><float name="temperature" value="-5"/></spectrum></emitter>',
     '"temperature" must be greater than 0'),
    # lens
    (2, '<sensor type="thinlens"/>', '<float name="aperture_radius"> is missing'),
    (3, thin_lens("float aperture_radius -0.1"), '"aperture_radius" must not be negative, got -0.1'),
    (3, thin_lens("float aperture_radius nan"), 'expected a finite number, got "nan"'),
    (3, thin_lens("float aperture_radius inf"), 'expected a finite number, got "inf"'),
    (4, thin_lens("float aperture_radius 0.1", "float focus_distance 0"), '"focus_distance" must be greater than 0, got 0'),
    (4, thin_lens("float aperture_radius 0.1", "float focus_distance -2"), "greater than 0, got -2"),
    (4, thin_lens("float aperture_radius 0.1", "float focus_distance nan"), 'expected a finite number, got "nan"'),
    (4, thin_lens("float aperture_radius 0.1", "float focus_distance -inf"), 'expected a finite number, got "-inf"'),
    (4, thin_lens("float aperture_radius 0.1", "integer aperture_blades 2"), "0, a disk, or at least 3, got 2"),
    (4, thin_lens("float aperture_radius 0.1", "integer aperture_blades -5"), '"aperture_blades" must be from 0'),
    (4, thin_lens("float aperture_radius 0.1", "float principal_point_offset_x 0.1"), 'no parameter "principal_point'),
    (2, '<sensor type="perspective"><float name="aperture_radius" value="1"/></sensor>', 'no parameter "aperture_radius"'),
    # motion
    (4, animated(key(1), key(1)), '<transform>', "the times of keyframes must increase, got 1 after 1"),
    (5, animated(key(0), key(2), key(1)), "must increase, got 1 after 2"),
    (2, animated(key(0)), "<animation", 'needs two <transform time="..."> or more, got 1'),
    (2, animated(), "needs two", "got 0"),
    (4, animated(key(0), "<transform/>"), 'attribute "time" is missing'),
    (4, animated(key(0), key("nan")), 'expected a finite number, got "nan"'),
    (4, animated(key(0), key(1, '<scale x="0" y="1"/>')), "<scale>", "singular"),
    (4, animated(key(0), key(1, '<scale x="-1"/>')), "inside out"),
    (4, animated(key(0), key(1, '<rotate x="1" angle="inf"/>')), "finite"),
    (4, animated(key(0), "<translate/>"), 'made of <transform time="..."> alone'),
    (2, animated(key(0), key(1, '<scale x="2"/>'), kind='shape type="sphere"'), "equally along all axes"),
    (2, animated(key(0), key(1, '<scale value="2"/>'), kind='sensor type="perspective"'), "must not scale or shear"),
    (2, animated(key(0), key(1), kind='emitter type="point"'), '<emitter type="point"> cannot move'),
    (2, animated(key(0), key(1), kind='emitter type="constant"'), '<emitter type="constant"> cannot move'),
    (2, animated(key(0), key(1), kind='bsdf type="diffuse"'), 'no parameter "to_world"'),
    (2, '<shape type="disk">' + 2 * '<animation name="to_world"><transform time="0"/><transform time="1"/></animation>' +
     "</shape>", '"to_world" is given twice'),
    (2, '<sensor type="perspective"><float name="shutter_open" value="1"/></sensor>', "must not close before it opens"),
    (2, '<sensor type="perspective"><float name="shutter_open" value="1"/><float name="shutter_close" value="0.5"/></sensor>',
     "shutter_open is 1, shutter_close 0.5"),
    # transforms
    (3, to_world('<scale value="0"/>'), "<scale>", "singular"),
    (3, to_world('<scale x="2" y="0"/>'), "<scale>", "singular"),
    (3, to_world('<matrix value="1 2 3 2 4 6 0 0 1"/>'), "<matrix>", "singular"),
    (3, to_world('<matrix value="1 0 0 0 1 0"/>'), "expected 16 or 9 numbers, got 6"),
    (3, to_world('<matrix value="1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1"/>'), "the last row must be 0 0 0 1, got 1 0 0 1"),
    (3, to_world('<matrix value="1 0 0 0 nan 0 0 0 1"/>'), 'expected a finite number, got "nan"'),
    (3, to_world('<rotate angle="30"/>'), "the rotation axis must not be zero"),
    (3, to_world('<rotate x="1" y="1" angle="30"/>'), "length 1, got 1.41421", "0.707107"),
    (3, to_world('<rotate x="1"/>'), 'attribute "angle" is missing'),
    (3, to_world('<lookat origin="1 2 3" target="1 2 3"/>'), "must not be the same point"),
    (3, to_world('<lookat origin="0 0 0" target="0 2 0" up="0 1 0"/>'), "up must not be parallel"),
    (3, to_world('<lookat origin="0 0" target="0 2 0"/>'), "expected 3 numbers, got 2"),
    (3, to_world('<scale value="1e200"/><scale value="1e200"/>'), "not finite"),
    (2, to_world('<scale x="2"/>', "sphere"), "equally along all axes"),
    (2, to_world('<scale x="2"/>', "cylinder"), "round and upright"),
    (2, '<sensor type="perspective"><transform name="to_world"><scale value="2"/></transform></sensor>', "scale or shear"),
    # files
    (2, '<shape type="ply"><string name="filename" value="none.ply"/></shape>', 'no file "none.ply"'),
    (2, '<shape type="obj"><string name="filename" value="bad.obj"/></shape>', "bad.obj", "index"),
    (2, '<shape type="obj"><string name="filename" value="nan.obj"/></shape>', "1 vertices that are not finite"),
    (2, '<shape type="obj"><string name="filename" value="sky.exr"/></shape>', ".obj or .ply"),
    (2, '<texture type="bitmap"><string name="filename" value="none.png"/></texture>', 'no file "none.png"'),
    (2, '<texture type="bitmap"><string name="filename" value="bad.obj"/></texture>', "bad.obj", "cannot read the image"),
    (2, '<texture type="bitmap"><string name="filename" value="nan.exr"/></texture>', "column 1, row 0", "nan"),
    (2, '<texture type="bitmap"><string name="filename" value="sky.exr"/></texture>', "column 0, row 0", "from 0 to 1"),
    (2, '<emitter type="envmap"><string name="filename" value="negative.exr"/></emitter>', "column 0, row 1", "-1"),
    (3, diffuse('<spectrum name="reflectance" filename="none.spd"/>'), 'no file "none.spd"'),
    (3, diffuse('<spectrum name="reflectance" filename="bad.obj"/>'), "bad.obj", "a wavelength and a value"),
    (2, '<include filename="none.xml"/>', 'no file "none.xml"'),
    (2, '<include filename="test.xml"/>', "in a circle"),
    # names
    (3, '<bsdf type="diffuse" id="a"/>\n<shape type="disk" id="a"/>', 'the id "a" is already taken', ":2"),
    (2, '<shape type="disk"><ref id="wal"/></shape><bsdf type="diffuse" id="wall"/>', 'the id "wal"', '"wall"?'),
    (2, '<shape type="disk"><ref/></shape>', 'attribute "id" is missing'),
    (2, '<bsdf type="twosided" id="a"><bsdf type="twosided"><ref id="a"/></bsdf></bsdf>', "circular reference"),
    (2, '<alias id="a" as="b"/>', 'nothing has the id "a"'),
    (3, diffuse('<ref name="reflectance" id="a"/>') + '<bsdf type="diffuse" id="a"/>', "not <bsdf>"),
    (2, '<shape type="sphere"><float name="radius" value="$r"/></shape>', 'undefined parameter "$r"'),
    (3, '<default name="size" value="1"/>\n<shape type="sphere"><float name="radius" value="$sise"/></shape>', '"size"?'),
    (2, '<default name="" value="1"/>', "must not be empty"),
    (2, '<default name="r" value="x"/><shape type="sphere"><float name="radius" value="$r"/></shape>', 'got "x"'),
]  # fmt: skip

# Whole files: line, text, what the message must name.
FILES = [
    (1, "", "not well-formed XML"),
    (1, "this is no XML", "not well-formed XML"),
    (2, '<scene version="3.0.0">\n<shape type="disk"></scene>', "not well-formed XML"),
    (2, '<scene version="3.0.0">\n<shape type=disk/></scene>', "not well-formed XML"),
    (2, '<scene version="3.0.0">\n<string name="a" value="&file;"/></scene>', "not well-formed XML", "file"),
    (1, '<!DOCTYPE scene [<!ENTITY a "b">]>\n<scene version="3.0.0"/>', "not allowed"),
    (1, '<!DOCTYPE scene SYSTEM "file:///etc/passwd">\n<scene version="3.0.0"/>', "not allowed"),
    (1, f"<scene>{SENSOR}</scene>", '"version" is missing'),
    (1, f'<scene version="0.6.0">{SENSOR}</scene>', "0.6.0", "3.0.0"),
    (1, f'<scene version="4.0.0">{SENSOR}</scene>', "4.0.0", "3.0.0"),
    (1, f'<scene version="3">{SENSOR}</scene>', "three numbers"),
    (1, f'<szene version="3.0.0">{SENSOR}</szene>', "<szene>"),
    (1, '<shape type="disk" version="3.0.0"/>', "must be <scene>"),
    (1, '<scene version="3.0.0"/>', '<sensor type="perspective"> is missing'),
]
