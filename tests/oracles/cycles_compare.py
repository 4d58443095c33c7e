"""A second opinion on gi/engines/reference that shares none of its code: the same surfels in Blender's Cycles.

    cmake --build --preset release --target lucarne surfel_dump
    blender -b --factory-startup -P tests/oracles/cycles_compare.py -- cornell front 300k
    blender -b --factory-startup -P tests/oracles/cycles_compare.py -- nave nave 600k

(Debian: blender, python3-numpy.) Generates and converts the scan, renders the camera of data/scenes/SCENE.json with
the reference (two halves) and with Cycles (two seeds), with 0, 1 and 3 bounces, and prints how far the mean
luminances are apart, over all pixels and over those that are no neighbours of an edge of depth or normal, and how much
of that is noise. At edges the two see different surfaces: Cycles the nearest disc with all that sticks out of it, the
reference what the G-buffer holds. Succeeds where the pixels away from edges agree within 1 % plus noise.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

import bpy
import mathutils
import numpy

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.environ.get("LUCARNE_BUILD", os.path.join(SOURCE, "build", "release"))
SIZE, SAMPLES, BLOCK, BOUNCES = 256, 32, 32, (0, 1, 3)
EDGE = 4  # pixels beside an edge of depth or normal that count as its own
NEAREST = 1  # radii; as far as the rays of gi/engines/reference start above their surface
CORNERS = 8  # of the polygon that stands for a disc, with the disc's area


def run(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def lucarne(*arguments):
    run(os.path.join(BUILD, "lucarne"), *arguments)


def add_surfels(surfels):
    """One mesh of octagons, each with the albedo of its surfel."""
    position, normal, albedo, radius = surfels[:, 0:3], surfels[:, 3:6], surfels[:, 6:9], surfels[:, 9]
    helper = numpy.where(numpy.abs(normal[:, 2:3]) < .9, [[0, 0, 1]], [[1, 0, 0]])
    u = numpy.cross(helper, normal)
    u /= numpy.linalg.norm(u, axis=1, keepdims=True)
    v = numpy.cross(normal, u)
    reach = radius * math.sqrt(math.pi / (CORNERS / 2 * math.sin(2 * math.pi / CORNERS)))
    angles = 2 * math.pi * numpy.arange(CORNERS) / CORNERS
    around = numpy.cos(angles)[None, :, None] * u[:, None, :] + numpy.sin(angles)[None, :, None] * v[:, None, :]
    points = (position[:, None, :] + reach[:, None, None] * around).astype(numpy.float32)
    count = len(surfels)
    mesh = bpy.data.meshes.new("surfels")
    mesh.vertices.add(count * CORNERS)
    mesh.vertices.foreach_set("co", points.ravel())
    mesh.loops.add(count * CORNERS)
    mesh.loops.foreach_set("vertex_index", numpy.arange(count * CORNERS, dtype=numpy.int32))
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, count * CORNERS, CORNERS, dtype=numpy.int32))
    mesh.polygons.foreach_set("loop_total", numpy.full(count, CORNERS, dtype=numpy.int32))
    mesh.update(calc_edges=True)
    color = numpy.ones((count, CORNERS, 4), dtype=numpy.float32)
    color[:, :, :3] = numpy.minimum(albedo, .95)[:, None, :]
    mesh.attributes.new("albedo", "FLOAT_COLOR", "POINT").data.foreach_set("color", color.ravel())
    material = bpy.data.materials.new("surfels")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    attribute, diffuse = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeBsdfDiffuse")
    output = nodes.new("ShaderNodeOutputMaterial")
    attribute.attribute_name = "albedo"
    links.new(attribute.outputs["Color"], diffuse.inputs["Color"])
    # Discs of one surface lie in one another, and rays would hit those beside the one that they leave: what is nearer
    # than a radius is air.
    path, far = nodes.new("ShaderNodeLightPath"), nodes.new("ShaderNodeMath")
    clear, mix = nodes.new("ShaderNodeBsdfTransparent"), nodes.new("ShaderNodeMixShader")
    far.operation = "GREATER_THAN"
    far.inputs[1].default_value = NEAREST * float(numpy.median(radius))
    links.new(path.outputs["Ray Length"], far.inputs[0])
    links.new(far.outputs["Value"], mix.inputs["Fac"])
    links.new(clear.outputs["BSDF"], mix.inputs[1])
    links.new(diffuse.outputs["BSDF"], mix.inputs[2])
    links.new(mix.outputs["Shader"], output.inputs["Surface"])
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("surfels", mesh))


def add_spot(spot):
    """A point light whose shader gives it the spot's edge; Cycles' own spots fall off otherwise."""
    light = bpy.data.lights.new("spot", "POINT")
    light.shadow_soft_size = 0
    light.energy = 4 * math.pi  # W, which is an intensity of 1 W/sr
    light.use_nodes = True
    nodes, links = light.node_tree.nodes, light.node_tree.links
    nodes.clear()
    geometry, cosine = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath")
    edge, emission = nodes.new("ShaderNodeMapRange"), nodes.new("ShaderNodeEmission")
    output = nodes.new("ShaderNodeOutputLight")
    axis = numpy.subtract(spot["target"], spot["position"])
    half = math.radians(spot.get("angle", 60)) / 2
    cosine.operation = "DOT_PRODUCT"
    cosine.inputs[1].default_value = axis / numpy.linalg.norm(axis)
    edge.interpolation_type = "SMOOTHSTEP"
    edge.inputs["From Min"].default_value = math.cos(half)
    edge.inputs["From Max"].default_value = math.cos(half * (1 - spot.get("softness", .1)))
    emission.inputs["Color"].default_value = (*spot["intensity"], 1)
    links.new(geometry.outputs["Incoming"], cosine.inputs[0])  # from the light to what it lights
    links.new(cosine.outputs["Value"], edge.inputs["Value"])
    links.new(edge.outputs["Result"], emission.inputs["Strength"])
    links.new(emission.outputs["Emission"], output.inputs["Surface"])
    object_ = bpy.data.objects.new("spot", light)
    object_.location = spot["position"]
    bpy.context.scene.collection.objects.link(object_)


def add_camera(camera):
    forward = numpy.subtract(camera["target"], camera["position"])
    forward /= numpy.linalg.norm(forward)
    right = numpy.cross(forward, camera.get("up", [0, 0, 1]))
    right /= numpy.linalg.norm(right)
    axes = numpy.stack([right, numpy.cross(right, forward), -forward], axis=1)
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(camera.get("fov", 60))
    data.clip_start, data.clip_end = .01, 1e4
    object_ = bpy.data.objects.new("camera", data)
    matrix = numpy.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, camera["position"]
    object_.matrix_world = mathutils.Matrix(matrix.tolist())
    bpy.context.scene.collection.objects.link(object_)
    bpy.context.scene.camera = object_


def set_up(surfels, scene, camera):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    here = bpy.context.scene
    here.render.engine = "CYCLES"
    here.render.resolution_x = here.render.resolution_y = SIZE
    here.render.resolution_percentage = 100
    here.render.image_settings.file_format = "OPEN_EXR"
    here.render.image_settings.color_depth = "32"
    here.render.image_settings.color_mode = "RGB"
    cycles = here.cycles
    cycles.samples = SAMPLES
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.transparent_max_bounces = 64
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", .01  # the middle of each pixel
    add_surfels(surfels)
    for light in scene["lights"]:
        assert light["type"] == "spot"
        add_spot(light)
    add_camera(camera)


def pixels_of(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    image.alpha_mode = "CHANNEL_PACKED"
    values = numpy.empty(SIZE * SIZE * 4, dtype=numpy.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    return values.reshape(SIZE, SIZE, 4).astype(float)


def luminance_of(path):
    return pixels_of(path)[:, :, :3] @ [.2126, .7152, .0722]


def grown(mask, steps):
    for _ in range(steps):
        wide = numpy.pad(mask, 1)
        mask = (wide[1:-1, 1:-1] | wide[:-2, 1:-1] | wide[2:, 1:-1] | wide[1:-1, :-2] | wide[1:-1, 2:])
    return mask


def edges(gbuffer):
    """Where the depth bends by over 2 % or the normal turns by over 25 degrees from pixel to pixel, and around."""
    normal, depth = gbuffer[:, :, :3], gbuffer[:, :, 3]
    found = depth <= 0
    for axis in (0, 1):
        bend = numpy.abs(numpy.diff(depth, 2, axis=axis)) > .02 * numpy.take(depth, range(1, SIZE - 1), axis)
        turn = numpy.sum(numpy.take(normal, range(1, SIZE), axis) * numpy.take(normal, range(SIZE - 1), axis), 2) < .9
        pad = [(0, 0), (0, 0)]
        pad[axis] = (1, 1)
        found |= numpy.pad(bend, pad)
        pad[axis] = (1, 0)
        found |= numpy.pad(turn, pad)
    return grown(found, EDGE)


def cycles_luminance(folder, bounces, seed):
    here = bpy.context.scene
    cycles = here.cycles
    cycles.max_bounces = cycles.diffuse_bounces = bounces
    cycles.seed = seed
    here.render.filepath = os.path.join(folder, f"cycles-{bounces}-{seed}.exr")
    bpy.ops.render.render(write_still=True)
    return luminance_of(here.render.filepath)


def compare(folder, cache, scene_file, camera, bounces):
    ours, gbuffer = (os.path.join(folder, f"{name}-{bounces}.exr") for name in ("reference", "gbuffer"))
    lucarne("render", cache, "-o", ours, "--scene", scene_file, "--camera", camera, "--engine", "reference",
            "--preset", "high", "--size", f"{SIZE}x{SIZE}", "--bounces", str(bounces), "--samples", str(SAMPLES),
            "--layers", "--gbuffer", gbuffer)
    a, b = (luminance_of(ours.replace(".exr", half)) for half in (".a.exr", ".b.exr"))
    c, d = (cycles_luminance(folder, bounces, seed) for seed in (1, 2))
    away = ~edges(pixels_of(gbuffer))
    for what, chosen in (("all pixels", away | True), (f"{100 * away.mean():.0f} % away from edges", away)):
        r1, r2, c1, c2 = (picture[chosen].mean() for picture in (a, b, c, d))
        mean = (c1 + c2) / 2
        difference = (r1 + r2) / 2 / mean - 1
        # Half the difference of two halves has the standard error of their mean.
        noise = math.hypot(r1 - r2, c1 - c2) / 2 / mean
        print(f"RESULT {bounces} bounces, {what}: Cycles {mean:.5f}, reference {100 * difference:+.2f} % "
              f"(noise {100 * noise:.2f} %)", flush=True)
    return abs(difference) <= .01 + 3 * noise


def main():
    name, camera, points = sys.argv[sys.argv.index("--") + 1:]
    scene_file = os.path.join(SOURCE, "data", "scenes", name + ".json")
    with open(scene_file, encoding="utf-8") as file:
        scene = json.load(file)
    with tempfile.TemporaryDirectory() as folder:
        scan, cache, dump = (os.path.join(folder, f) for f in ("scan.ply", "scan.luc", "surfels.bin"))
        lucarne("generate", name, "--even", "--normals", "--points", points, "-o", scan)
        lucarne("convert", scan, "-o", cache)
        print(run(os.path.join(BUILD, "tests", "surfel_dump"), cache, dump), end="")
        surfels = numpy.fromfile(dump, dtype="<f4").reshape(-1, 11).astype(float)
        set_up(surfels, scene, next(c for c in scene["cameras"] if c["name"] == camera))
        agree = [compare(folder, cache, scene_file, camera, bounces) for bounces in BOUNCES]
    print("RESULT agree within 1 % plus noise" if all(agree) else "RESULT disagree")
    sys.exit(0 if all(agree) else 1)


main()
