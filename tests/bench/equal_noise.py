#!/usr/bin/env python3
"""CPU seconds to equal noise, on the thesis's diffuse room, against Blender's Cycles (Debian: blender, openimageio-tools).

Both programs trace paths through the same geometry, one thread each: the room with its box and ball, lit by a luminous ball, where all
is diffuse: the caustics of the mirror and the glass, which neither program samples, would hide all other noise. Noise is the root
mean square of the difference from the program's own converged picture, at 16, 64 and 256 samples. Cycles gets its
default sampler, a point light with a radius (its sphere light), no clamping, no denoiser, no adaptive sampling, and as
many bounces. CPU time is of the process, less what it takes for one sample: so loading doesn't count. That the
converged pictures agree is checked, too.

    tests/bench/equal_noise.py [--width 240] [--converged 4096] [--json F]
"""
import argparse
import json
import math
import os
import pathlib
import re
import resource
import shutil
import subprocess
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = (16, 64, 256)
BOUNCES = 16
EYE, FIELD_OF_VIEW = (8, -1, 23), 90  # looks along -z
WHITE, RED, GREEN, BLUE = (0.56,) * 3, (0.56, 0.175, 0.175), (0.175, 0.56, 0.175), (0.175, 0.175, 0.56)
LAMP_CENTER, LAMP_RADIUS, LAMP_RADIANCE = (12, -1, 22), 0.3, 280
BALL_CENTER, BALL_RADIUS = (9.5, -2.25, 14.5), 0.75


def polygons():
    """(colour, points) of the room and the box."""
    yield WHITE, [(0, -3, 0), (0, -3, 24), (16, -3, 24), (16, -3, 0)]
    yield GREEN, [(0, 3, 0), (16, 3, 0), (16, 3, 24), (0, 3, 24)]
    yield RED, [(0, -3, 0), (0, 3, 0), (0, 3, 24), (0, -3, 24)]
    yield WHITE, [(0, -3, 0), (16, -3, 0), (16, 3, 0), (0, 3, 0)]
    yield BLUE, [(16, -3, 0), (16, -3, 24), (16, 3, 24), (16, 3, 0)]
    yield WHITE, [(0, -3, 24), (0, 3, 24), (16, 3, 24), (16, -3, 24)]
    box = [(WHITE, [(-0.5, -1, -2.3), (-0.5, -1, 2.3), (0.5, -1, 2.3), (0.5, -1, -2.3)]),
           (BLUE, [(-0.5, 1, -2.3), (0.5, 1, -2.3), (0.5, 1, 2.3), (-0.5, 1, 2.3)]),
           (GREEN, [(-0.5, -1, -2.3), (-0.5, 1, -2.3), (-0.5, 1, 2.3), (-0.5, -1, 2.3)]),
           (WHITE, [(-0.5, -1, -2.3), (0.5, -1, -2.3), (0.5, 1, -2.3), (-0.5, 1, -2.3)]),
           (WHITE, [(0.5, -1, -2.3), (0.5, -1, 2.3), (0.5, 1, 2.3), (0.5, 1, -2.3)])]
    c, s = math.cos(math.radians(-22)), math.sin(math.radians(-22))
    for color, points in box:
        yield color, [(c * x + s * z + 3.25, y - 1.99, -s * x + c * z + 14.75) for x, y, z in points]


def write_rayfarm(path):
    lines = [f"view: {{location: {list(EYE)}, direction: [0, 0, -1], field_of_view: {FIELD_OF_VIEW}, aspect: 1.3333333}}",
             "background: 0", "materials:", f"  lamp: {{luminaire: {{emission: {LAMP_RADIANCE}}}}}"]
    names = {}
    for color in (WHITE, RED, GREEN, BLUE):
        names[color] = f"m{len(names)}"
        lines.append(f"  {names[color]}: {{lambertian: {list(color)}}}")
    lines.append("scene:")
    for color, points in polygons():
        lines.append(f"  - {{material: {names[color]}, polygon: {{points: {[list(p) for p in points]}}}}}")
    lines.append(f"  - {{material: {names[WHITE]}, sphere: {{center: {list(BALL_CENTER)}, radius: {BALL_RADIUS}}}}}")
    lines.append(f"  - {{material: lamp, sphere: {{center: {list(LAMP_CENTER)}, radius: {LAMP_RADIUS}}}}}")
    path.write_text("\n".join(lines) + "\n")


def write_blender(path, width, height):
    """A script that Blender runs: it builds the scene and renders it with the samples and seed after `--`."""
    watts = LAMP_RADIANCE * 4 * math.pi ** 2 * LAMP_RADIUS ** 2
    path.write_text(f"""
import bpy, sys
from mathutils import Matrix
samples, seed, output = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
def material(color):
    m = bpy.data.materials.new("m")
    m.use_nodes = True
    nodes = m.node_tree.nodes
    nodes.clear()
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*color, 1)
    shader.inputs["Roughness"].default_value = 0
    out = nodes.new("ShaderNodeOutputMaterial")
    m.node_tree.links.new(shader.outputs[0], out.inputs["Surface"])
    return m
def add(data, color):
    data.materials.append(material(color))
    thing = bpy.data.objects.new("o", data)
    scene.collection.objects.link(thing)
    return thing
for color, points in {list(polygons())!r}:
    mesh = bpy.data.meshes.new("p")
    mesh.from_pydata(points, [], [tuple(range(len(points)))])
    add(mesh, color)
bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64, radius={BALL_RADIUS}, location={BALL_CENTER})
ball = bpy.context.object
ball.data.materials.append(material({WHITE}))
bpy.ops.object.shade_smooth()
lamp = bpy.data.lights.new("lamp", "POINT")
lamp.energy = {watts}
lamp.shadow_soft_size = {LAMP_RADIUS}
lamp.cycles.max_bounces = 1024
lamp.cycles.use_multiple_importance_sampling = True
light = bpy.data.objects.new("lamp", lamp)
light.location = {LAMP_CENTER}
scene.collection.objects.link(light)
camera = bpy.data.cameras.new("camera")
camera.sensor_fit = "HORIZONTAL"
camera.angle = {math.radians(FIELD_OF_VIEW)}
camera.clip_end = 1000
eye = bpy.data.objects.new("camera", camera)
eye.location = {EYE}  # cameras look along -z
scene.collection.objects.link(eye)
scene.camera = eye
scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0
scene.render.engine = "CYCLES"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = {width}, {height}, 100
scene.render.threads_mode, scene.render.threads = "FIXED", 1
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.filepath = output
cycles = scene.cycles
cycles.device = "CPU"
cycles.samples, cycles.seed = int(samples), int(seed)
cycles.use_adaptive_sampling = cycles.use_denoising = False
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
cycles.pixel_filter_type = "BOX"
cycles.max_bounces = cycles.diffuse_bounces = {BOUNCES}
cycles.light_sampling_threshold = 0
bpy.ops.render.render(write_still=True)
""")


def run(command, folder):
    """CPU seconds of a child."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, cwd=folder, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def rayfarm(samples, seed, output, size, folder):
    return run([SOURCE / "build/rayfarm", "render", "room.yaml", "--lighting", "path", "--max-depth", str(BOUNCES + 1),
                "--samples", str(samples), "--seed", str(seed), "--size", size, "--pixel-format", "float",
                "--local-nodes", "1", "-q", "-o", output], folder)


def cycles(samples, seed, output, _, folder):
    return run(["blender", "-b", "--factory-startup", "-t", "1", "--python-exit-code", "1", "-P", folder / "room.py",
                "--", str(samples), str(seed), folder / output], folder)


def oiio(folder, *arguments):
    return subprocess.run(["oiiotool", *arguments], capture_output=True, text=True, cwd=folder).stdout


def rms(a, b, folder):
    return float(re.search(r"RMS error = (\S+)", oiio(folder, a, b, "--diff")).group(1))


def mean(picture, folder):
    numbers = re.search(r"Stats Avg: (\S+) (\S+) (\S+)", oiio(folder, "--stats", picture)).groups()
    return sum(map(float, numbers)) / 3


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--width", type=int, default=240, help="of the picture, in pixels")
    parser.add_argument("--converged", type=int, default=4096, help="samples of the converged pictures")
    parser.add_argument("--keep", type=pathlib.Path, help="leave pictures and scenes in this folder")
    parser.add_argument("--json", type=pathlib.Path, help="write the results here")
    options = parser.parse_args()
    for program in ("blender", "oiiotool"):
        if not shutil.which(program):
            parser.error(f"{program} was not found; apt-get install blender openimageio-tools")
    if not os.access(SOURCE / "build/rayfarm", os.X_OK):
        parser.error("build/rayfarm was not found; run deploy/setup first")
    width, height = options.width, options.width * 3 // 4
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep.resolve() if options.keep else pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        write_rayfarm(folder / "room.yaml")
        write_blender(folder / "room.py", width, height)
        results = {}
        for name, render in (("rayfarm", rayfarm), ("cycles", cycles)):
            converged, size = f"{name}-converged.exr", f"{width}x{height}"
            render(options.converged, 1000, converged, size, folder)
            start = min(render(1, 1, f"{name}-1.exr", size, folder) for _ in range(3))
            rows = []
            for samples in SAMPLES:
                picture = f"{name}-{samples}.exr"
                seconds = min(render(samples, 1 + i, picture, size, folder) for i in range(3)) - start
                seconds *= samples / (samples - 1)
                rows.append((samples, seconds, rms(picture, converged, folder)))
                print(f"{name:<8} {samples:>5} samples {seconds:>9.3f} CPU s, RMS noise {rows[-1][2]:.5f}", flush=True)
            results[name] = {"rows": rows, "mean": mean(converged, folder)}
        apart = rms("rayfarm-converged.exr", "cycles-converged.exr", folder)
    ours, theirs = results["rayfarm"], results["cycles"]
    print(f"converged: means {ours['mean']:.5f} and {theirs['mean']:.5f}, RMS difference {apart:.5f}")
    ratios = []
    for samples, seconds, noise in theirs["rows"]:
        # Our time to the same noise: noise is a straight line over time where both are logarithms.
        points = [(math.log(t), math.log(n)) for _, t, n in ours["rows"]]
        mean_t, mean_n = (sum(p[i] for p in points) / len(points) for i in range(2))
        slope = sum((t - mean_t) * (n - mean_n) for t, n in points) / sum((t - mean_t) ** 2 for t, _ in points)
        needed = math.exp(mean_t + (math.log(noise) - mean_n) / slope)
        ratios.append(needed / seconds)
        print(f"to the noise of Cycles at {samples} samples: {needed:.3f} s against {seconds:.3f} s: {ratios[-1]:.2f}x")
    if options.json:
        options.json.write_text(json.dumps({"programs": results, "ratios": ratios, "converged_apart": apart}, indent=1))


if __name__ == "__main__":
    main()
