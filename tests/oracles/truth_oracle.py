"""Renders the true surfaces of virtual scenes with Mitsuba 3, as the truth for pictures of their scans.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install mitsuba==3.7.1 numpy
    cmake --build --preset release --target lucarne
    /tmp/venv/bin/python tests/oracles/truth_oracle.py [VIEW...]

Writes tests/oracles/truth/VIEW-bounce-K.exr (light after exactly K bounces, radiance, half floats) and
VIEW-surface.exr (unit normal toward the camera, depth along its forward axis in metres; all 0: nothing is visible).
Neither the program nor its tests need Mitsuba: they read these files.

The mesh is that of `lucarne generate SCENE --mesh`; light and camera are those of data/scenes/SCENE.json. Rays go
through the middles of the pixels, as in Lucarne's G-buffer. Every surface is diffuse and has two equal sides. Ray
casting, shading and path tracing are Mitsuba's; only the spot's edge is written here, because Mitsuba's own spots fall
off otherwise. Checks that no bounce is negative and prints the standard error of each picture's mean.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402  (after the variant)

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.environ.get("LUCARNE_BUILD", os.path.join(SOURCE, "build", "release"))
FOLDER = os.path.join(SOURCE, "tests", "oracles", "truth")
SIZE = 192
BOUNCES = 3
PATHS, PATHS_AT_ONCE = int(os.environ.get("PATHS", 2048)), 32  # a pixel
KEPT_BITS = 8  # of radiance: steps of .4 to .8 %
CHECKS = 6  # rounds of Mitsuba's path tracer
MESH_STEP = {"cornell": 1, "nave": .025}  # metres; surfaces of one colour are not divided
ALBEDO_CAP = .95
OFF_MIDDLE = (3e-4, 7e-4)  # pixels; rays exactly on the diagonal of a wall slip between its two triangles
PICTURES = {"cornell": {f"bounce-{k}": slice(k, k + 1) for k in range(BOUNCES + 1)},
            "nave": {"bounce-0": slice(0, 1), "bounces-1-to-3": slice(1, None)}}
VIEWS = {"cornell-front": ("cornell", "front"), "nave-nave": ("nave", "nave"), "nave-altar": ("nave", "altar")}


def linear(codes):
    """Decodes sRGB (IEC 61966-2-1)."""
    value = codes.astype(float) / 255
    return numpy.where(value <= .04045, value / 12.92, ((value + .055) / 1.055) ** 2.4)


def load_mesh(path):
    with open(path, "rb") as file:
        counts = []
        while (line := file.readline()) != b"end_header\n":
            if line.startswith(b"element"):
                counts.append(int(line.split()[2]))
        vertices = numpy.frombuffer(file.read(27 * counts[0]), dtype=[
            ("position", "<f4", 3), ("normal", "<f4", 3), ("albedo", "u1", 3)])
        faces = numpy.frombuffer(file.read(13 * counts[1]), dtype=[("count", "u1"), ("corners", "<u4", 3)])
    assert (faces["count"] == 3).all()
    reflectance = {"type": "mesh_attribute", "name": "vertex_color"}
    props = mi.Properties()
    props["bsdf"] = mi.load_dict({"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}})
    mesh = mi.Mesh("surface", counts[0], counts[1], has_vertex_normals=True, props=props)
    mesh.add_attribute("vertex_color", 3, numpy.minimum(linear(vertices["albedo"]), ALBEDO_CAP).ravel())
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = vertices["position"].ravel()
    parameters["faces"] = faces["corners"].ravel()
    parameters.update()
    # On their own: a change of positions replaces normals by means of the faces.
    parameters["vertex_normals"] = vertices["normal"].ravel()
    parameters.update()
    return mesh


class SmoothSpot(mi.Emitter):
    """A point whose intensity falls as the smoothstep of the cosine, from the inner to the outer angle."""

    def __init__(self, props):
        super().__init__(props)
        self.m_flags = mi.EmitterFlags.DeltaPosition
        # Kept as numbers, because arrays that are members may change their width while kernels are recorded.
        self.place = tuple(float(x) for x in numpy.ravel(props["position"]))
        axis = numpy.ravel(props["target"]) - numpy.array(self.place)
        self.forward = tuple(float(x) for x in axis / numpy.linalg.norm(axis))
        half = math.radians(props["angle"]) / 2
        self.outer, self.inner = math.cos(half), math.cos(half * (1 - props["softness"]))
        self.strength = tuple(float(x) for x in numpy.ravel(props["intensity"]))
        self.density = 1 / (2 * math.pi * (1 - self.outer))  # of direction(), per steradian

    @property
    def position(self):
        return mi.Point3f(*self.place)

    @property
    def axis(self):
        return mi.Vector3f(*self.forward)

    def direction(self, sample):
        """Draws a direction in the cone, evenly."""
        cosine = 1 - sample.x * (1 - self.outer)
        sine, angle = dr.safe_sqrt(1 - dr.square(cosine)), 2 * dr.pi * sample.y
        return mi.Frame3f(self.axis).to_world(mi.Vector3f(sine * dr.cos(angle), sine * dr.sin(angle), cosine))

    def sample_direction(self, it, sample, active=True):
        ds = mi.DirectionSample3f()
        ds.p, ds.n, ds.uv, ds.time = self.position, 0, 0, it.time
        ds.pdf, ds.delta, ds.emitter = 1, True, mi.EmitterPtr(self)
        ds.d = ds.p - it.p
        ds.dist = dr.norm(ds.d)
        ds.d /= ds.dist
        t = dr.clip((dr.dot(-ds.d, self.axis) - self.outer) / (self.inner - self.outer), 0, 1)
        return ds, mi.Color3f(*self.strength) * (t * t * (3 - 2 * t) / dr.square(ds.dist)) & active

    def pdf_direction(self, it, ds, active=True):
        return mi.Float(0)

    def eval_direction(self, it, ds, active=True):
        return mi.Color3f(0)

    def eval(self, si, active=True):
        return mi.Color3f(0)

    def bbox(self):
        return mi.BoundingBox3f(self.position)


mi.register_emitter("smooth_spot", SmoothSpot)


def load_scene(name):
    with open(os.path.join(SOURCE, "data", "scenes", name + ".json"), encoding="utf-8") as file:
        scene = json.load(file)
    assert not {"environment", "materials", "albedo"} & scene.keys()
    objects = {"type": "scene"}
    [light] = scene["lights"]
    assert light["type"] == "spot"
    spot = mi.load_dict({"type": "smooth_spot", "angle": light.get("angle", 60.), "softness": light.get("softness", .1)} | {
        key: mi.ScalarPoint3f(light[key]) for key in ("position", "target", "intensity")})
    objects["spot"] = spot
    with tempfile.TemporaryDirectory() as folder:
        mesh = os.path.join(folder, "mesh.ply")
        subprocess.run([os.path.join(BUILD, "lucarne"), "generate", name, "--mesh", mesh, "--mesh-step",
                        str(MESH_STEP[name])], check=True, stdout=subprocess.DEVNULL)
        objects["mesh"] = load_mesh(mesh)
    return mi.load_dict(objects), spot, {camera["name"]: camera for camera in scene["cameras"]}


def axes_of(camera):
    """Returns forward, right and up as in gi/shared/camera.h; fov is the vertical field of view."""
    forward = numpy.subtract(camera["target"], camera["position"])
    forward /= numpy.linalg.norm(forward)
    right = numpy.cross(forward, camera.get("up", [0, 0, 1]))
    right /= numpy.linalg.norm(right)
    reach = math.tan(math.radians(camera["fov"]) / 2)
    return forward, right * reach, numpy.cross(right, forward) * reach


def rays_of(camera, copies):
    """Returns rays through the middles of the pixels; the copies of a pixel follow each other."""
    forward, right, up = axes_of(camera)
    x, y = (2 * (numpy.arange(SIZE) + .5 + off) / SIZE - 1 for off in OFF_MIDDLE)
    directions = forward + x[None, :, None] * right - y[:, None, None] * up
    directions = numpy.repeat(directions.reshape(-1, 3), copies, axis=0)
    directions /= numpy.linalg.norm(directions, axis=1, keepdims=True)
    return mi.Ray3f(mi.Point3f(camera["position"]), mi.Vector3f(directions.T.astype(numpy.float32)))


def facing(si, normal):
    """Turns a normal toward the side from which a ray has hit the surface."""
    return dr.select(dr.dot(normal, si.to_world(si.wi)) < 0, -normal, normal)


def reflected(scene, spot, si, normal, active):
    """Returns the spot's light that a surface reflects to the side of `normal`: radiance, W/(sr m^2)."""
    ds, arriving = spot.sample_direction(si, mi.Point2f(0), active)
    cosine = dr.dot(normal, ds.d)
    active &= cosine > 0
    active &= ~scene.ray_test(si.spawn_ray_to(spot.position), active)
    return dr.select(active, si.bsdf().eval_diffuse_reflectance(si) / dr.pi * arriving * cosine, 0)


def density(spot, si, lit):
    """Returns the density of Spot.direction at a lit place, in solid angle about the place si."""
    to_light, to_si = spot.position - lit.p, si.p - lit.p
    return spot.density * (dr.abs(dr.dot(lit.n, dr.normalize(to_light))) * dr.squared_norm(to_si) /
                           (dr.squared_norm(to_light) * dr.abs(dr.dot(lit.n, dr.normalize(to_si)))))


def bounces_of(scene, spot, rays, sampler):
    """Follows one path per ray; returns the radiance after 0, 1, ... BOUNCES bounces, each alone.

    At every vertex the light after one more bounce is estimated by a direction drawn from the BRDF and by a place
    drawn where the spot shines, weighted by the balance heuristic (Veach and Guibas 1995)."""
    si = scene.ray_intersect(rays)
    active, through = si.is_valid(), mi.Color3f(1)
    normal = facing(si, si.sh_frame.n)
    found = [reflected(scene, spot, si, normal, mi.Bool(active))]
    for _ in range(BOUNCES):
        through *= si.bsdf().eval_diffuse_reflectance(si)
        # A place where the spot shines. A diffuse BRDF is albedo / pi, and directions are drawn with cos / pi.
        lit = scene.ray_intersect(mi.Ray3f(spot.position, spot.direction(sampler.next_2d())), active)
        away = dr.normalize(lit.p - si.p)
        cosine = dr.dot(normal, away)
        lit_normal = dr.select(dr.dot(lit.sh_frame.n, away) > 0, -lit.sh_frame.n, lit.sh_frame.n)
        connected = active & lit.is_valid() & (cosine > 0)
        connected &= ~scene.ray_test(si.spawn_ray_to(lit.p), connected)
        weight = (cosine / dr.pi) / (cosine / dr.pi + density(spot, si, lit))
        value = dr.select(connected, weight * reflected(scene, spot, lit, lit_normal, connected), 0)
        # A direction of the BRDF, which also continues the path.
        out = mi.warp.square_to_cosine_hemisphere(sampler.next_2d())
        after = scene.ray_intersect(si.spawn_ray(mi.Frame3f(normal).to_world(out)), active)
        active &= after.is_valid()
        after_normal = facing(after, after.sh_frame.n)
        weight = (out.z / dr.pi) / (out.z / dr.pi + density(spot, si, after))
        value += dr.select(active, weight * reflected(scene, spot, after, after_normal, mi.Bool(active)), 0)
        found.append(through * value)
        si, normal = after, after_normal
    return numpy.stack([numpy.array(value).T.reshape(-1, PATHS_AT_ONCE, 3).mean(axis=1) for value in found])


def mean_of_path(scene, rays, seed):
    """Returns the mean radiance of all bounces by Mitsuba's own path tracer, which finds lit places by chance."""
    integrator = mi.load_dict({"type": "path", "max_depth": BOUNCES + 2, "rr_depth": 1000})
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, dr.width(rays.d))
    return numpy.array(integrator.sample(scene, sampler, rays)[0]).mean()


def surface(scene, camera):
    rays = rays_of(camera, 1)
    si = scene.ray_intersect(rays)
    normal = numpy.array(dr.select(dr.dot(si.sh_frame.n, rays.d) > 0, -si.sh_frame.n, si.sh_frame.n)).T
    depth = numpy.array(si.t)[:, None] * (numpy.array(rays.d).T @ axes_of(camera)[0])[:, None]
    hit = numpy.array(si.is_valid())[:, None]
    return numpy.where(hit, numpy.concatenate([normal, depth], axis=1), 0)


def rounded(pixels):
    """Keeps the bits of half floats that paths do not fill with noise; the rest would not compress."""
    mantissa, exponent = numpy.frexp(pixels)
    return numpy.ldexp(numpy.round(mantissa * 2 ** KEPT_BITS) / 2 ** KEPT_BITS, exponent)


def write(name, pixels):
    image = mi.Bitmap(pixels.reshape(SIZE, SIZE, -1).astype(numpy.float16))
    image.write(os.path.join(FOLDER, name + ".exr"))


def render(view, scene, spot, camera, pictures):
    rays = rays_of(camera, PATHS_AT_ONCE)
    theirs = [mean_of_path(scene, rays, seed) for seed in range(CHECKS)]
    rounds = max(2, PATHS // PATHS_AT_ONCE)
    sums, means = numpy.zeros((BOUNCES + 1, SIZE * SIZE, 3)), []
    for seed in range(rounds):
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, dr.width(rays.d))
        values = bounces_of(scene, spot, rays, sampler)
        sums += values
        means.append(values.mean(axis=(1, 2)))
    errors = numpy.std(means, axis=0, ddof=1) / math.sqrt(rounds)
    for bounce, (mean, error) in enumerate(zip(numpy.mean(means, axis=0), errors)):
        print(f"{view}, bounce {bounce}: mean {mean:.5f} +- {100 * error / mean:.3f} %", flush=True)
    whole = numpy.sum(means, axis=1)
    noise = math.hypot(whole.std(ddof=1) / math.sqrt(rounds), numpy.std(theirs, ddof=1) / math.sqrt(CHECKS))
    difference = whole.mean() - numpy.mean(theirs)
    print(f"{view}, all bounces: {100 * difference / whole.mean():+.2f} +- {100 * noise / whole.mean():.2f} % against "
          "Mitsuba's path tracer", flush=True)
    assert abs(difference) < 4 * noise < .04 * whole.mean()
    for name, bounces in pictures.items():
        write(f"{view}-{name}", rounded(sums[bounces].sum(axis=0) / rounds))
    write(f"{view}-surface", surface(scene, camera))


def main():
    os.makedirs(FOLDER, exist_ok=True)
    views = sys.argv[1:] or VIEWS
    for name in dict.fromkeys(VIEWS[view][0] for view in views):
        scene, spot, cameras = load_scene(name)
        for view in views:
            if VIEWS[view][0] == name:
                render(view, scene, spot, cameras[VIEWS[view][1]], PICTURES[name])


main()
