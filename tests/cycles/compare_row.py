"""Renders the spheres of row.yaml with Blender's Cycles, and compares a picture of ours with that, block by block.

rayfarm render tests/cycles/row.yaml -o ours.exr --lighting path --samples 256 --max-depth 13 --pixel-format float
blender -b -P tests/cycles/compare_row.py -- ours.exr cycles.exr [SAMPLES]
"""
import math
import sys

import bpy
import mathutils

WIDTH, HEIGHT, BLOCK = 320, 160, 16
ROUGHNESS = (0.1, 0.25, 0.4, 0.6, 0.8, 1.0)
RADIUS, METALS, PLASTICS = 0.6, (1.9, -0.5), (0.6, 0)  # y and z of the rows
LOCATION, LOOK_AT, FIELD_OF_VIEW = (0, 2.2, 11), (0, 0.7, 0), 38
LAMP_SIZE, LAMP_RADIANCE = (4, 3), 10


def blender(p):
    """Of a point whose y axis is up."""
    return mathutils.Vector((p[0], -p[2], p[1]))


def material(node, **inputs):
    made = bpy.data.materials.new(node)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new(node), tree.nodes.new("ShaderNodeOutputMaterial")
    if node == "ShaderNodeBsdfPrincipled":
        shader.distribution = "MULTI_GGX"
    for name, value in inputs.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    tree.links.new(shader.outputs[0], output.inputs[0])
    return made


def x_of(column):
    return -3.25 + 1.3 * column


def build(scene):
    mesh = bpy.data.meshes.new("floor")
    mesh.from_pydata([blender(p) for p in ((-20, 0, 20), (20, 0, 20), (20, 0, -20), (-20, 0, -20))], [], [(0, 1, 2, 3)])
    mesh.materials.append(material("ShaderNodeBsdfDiffuse", Color=(0.5, 0.5, 0.5, 1)))
    scene.collection.objects.link(bpy.data.objects.new("floor", mesh))
    lamp = bpy.data.lights.new("lamp", "AREA")
    lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", *LAMP_SIZE
    lamp.energy = 4 * LAMP_SIZE[0] * LAMP_SIZE[1] * LAMP_RADIANCE
    lamp_object = bpy.data.objects.new("lamp", lamp)
    lamp_object.location = blender((0, 6, 2.5))
    scene.collection.objects.link(lamp_object)
    for column, roughness in enumerate(ROUGHNESS):
        for (y, z), color, metallic in ((METALS, (1, 1, 1, 1), 1), (PLASTICS, (0.6, 0.1, 0.08, 1), 0)):
            bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=RADIUS, location=blender((x_of(column), y, z)))
            bpy.ops.object.shade_smooth()
            bpy.context.object.data.materials.append(
                material("ShaderNodeBsdfPrincipled", Base_Color=color, Metallic=metallic, Roughness=roughness))
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.angle = "HORIZONTAL", math.radians(FIELD_OF_VIEW)
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location = blender(LOCATION)
    scene.camera.rotation_euler = (blender(LOOK_AT) - blender(LOCATION)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(scene.camera)
    scene.world = bpy.data.worlds.new("dark")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0, 0, 0, 1)


def render(scene, path, samples):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 12
    cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def blocks_of(path):
    """Of each block of 16 x 16 pixels, (row from the top, column), the mean red, green and blue."""
    pixels = bpy.data.images.load(path).pixels[:]  # RGBA, from the bottom
    blocks = {}
    for y in range(HEIGHT):
        for x in range(WIDTH):
            first = 4 * ((HEIGHT - 1 - y) * WIDTH + x)
            sums = blocks.setdefault((y // BLOCK, x // BLOCK), [0.0, 0.0, 0.0])
            for c in range(3):
                sums[c] += pixels[first + c] / BLOCK**2
    return blocks


def mean_about(blocks, row, column):
    values = [v for y in (-1, 0, 1) for x in (-1, 0, 1) for v in blocks[row + y, column + x]]
    return sum(values) / len(values)


def block_of(y, z, column):
    """The block in which the middle of a sphere is seen."""
    forward = (blender(LOOK_AT) - blender(LOCATION)).normalized()
    right = forward.cross(mathutils.Vector((0, 0, 1))).normalized()
    to = blender((x_of(column), y, z)) - blender(LOCATION)
    scale = WIDTH / 2 / math.tan(math.radians(FIELD_OF_VIEW / 2)) / to.dot(forward)
    return int((HEIGHT / 2 - to.dot(right.cross(forward)) * scale) / BLOCK), int((WIDTH / 2 + to.dot(right) * scale) / BLOCK)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    ours_path, path = arguments[:2]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    build(scene)
    render(scene, path, int(arguments[2]) if len(arguments) > 2 else 256)
    ours, theirs = blocks_of(ours_path), blocks_of(path)
    pairs = [pair for key in ours for pair in zip(ours[key], theirs[key])]
    means = [sum(pair[i] for pair in pairs) / len(pairs) for i in (0, 1)]
    print("all blocks: RMS of differences over the mean %.3f; means %.4f and %.4f" %
          (math.sqrt(sum((a - b)**2 for a, b in pairs) / len(pairs)) / means[1], *means))
    for name, (y, z) in (("metals", METALS), ("plastics", PLASTICS)):
        for column, roughness in enumerate(ROUGHNESS):
            a, b = (mean_about(blocks, *block_of(y, z, column)) for blocks in (ours, theirs))
            print("%s of roughness %g, 3 x 3 blocks about the middle: %.4f and %.4f, %+.1f %%" %
                  (name, roughness, a, b, 100 * (a / b - 1)))


main()
