"""Draws a ground with Blender's Cycles: soft sun and sky, a cut block on a table.

    python3 tests/tools/cycles_picture.py JOB.npz OUT.png

JOB has heights as drawn in rows from the north, colors of sRGB, the side of a cell in meters, the camera's eye from the north-western
post, its direction, its vertical field of view in degrees and the size in pixels; `side_by_side.py` writes it. Needs bpy.
"""

import math
import sys

import bpy
import mathutils
import numpy

# Meters in a unit of Blender, whose tools expect small numbers.
UNIT_M = 1000.0

SUN_AZIMUTH_DEG, SUN_ALTITUDE_DEG = 315, 40


def material(name, color=None):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    surface = made.node_tree.nodes["Principled BSDF"]
    surface.inputs["Roughness"].default_value = 1.0
    surface.inputs["Specular IOR Level"].default_value = 0.0
    if color:
        surface.inputs["Base Color"].default_value = (*color, 1)
    return made


def add_mesh(name, vertices, faces, surface):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces)
    mesh.update()
    mesh.materials.append(surface)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    return mesh


def main(job_path, out):
    job = numpy.load(job_path)
    heights, colors, cell = job["heights"], job["colors"], float(job["cell"])
    rows, columns = heights.shape
    heights = numpy.nan_to_num(heights, nan=float(numpy.nanmin(heights)))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    x, y = numpy.meshgrid(numpy.arange(columns) * cell, -numpy.arange(rows) * cell)
    vertices = numpy.stack([x, y, heights], -1).reshape(-1, 3) / UNIT_M
    index = numpy.arange(rows * columns).reshape(rows, columns)
    faces = numpy.stack([index[1:, :-1], index[1:, 1:], index[:-1, 1:], index[:-1, :-1]], -1).reshape(-1, 4)
    tinted = material("ground")
    ground = add_mesh("ground", vertices, faces.tolist(), tinted)
    ground.polygons.foreach_set("use_smooth", [True] * len(ground.polygons))
    linear = numpy.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    attribute = ground.color_attributes.new("tint", "FLOAT_COLOR", "POINT")
    buffer = numpy.ones((rows * columns, 4), "f4")
    buffer[:, :3] = linear.reshape(-1, 3)
    attribute.data.foreach_set("color", buffer.ravel())
    node = tinted.node_tree.nodes.new("ShaderNodeVertexColor")
    node.layer_name = "tint"
    tinted.node_tree.links.new(node.outputs["Color"], tinted.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    base = vertices[:, 2].min() - max(columns, rows) * cell * 0.02 / UNIT_M
    earth = material("earth", (0.16, 0.12, 0.09))
    for name, edge in (("s", index[-1, :]), ("n", index[0, ::-1]), ("w", index[:, 0]), ("e", index[::-1, -1])):
        top = vertices[edge]
        bottom = top.copy()
        bottom[:, 2] = base
        count = len(edge)
        wall = [(i, i + 1, count + i + 1, count + i) for i in range(count - 1)]
        add_mesh(name, numpy.concatenate([top, bottom]), wall, earth)
    bpy.ops.mesh.primitive_plane_add(size=1000, location=(0, 0, base - 0.001))
    bpy.context.object.data.materials.append(material("table", (0.82, 0.80, 0.77)))
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle, sun.color = 3.2, math.radians(6), (1, 0.95, 0.86)
    lamp = bpy.data.objects.new("sun", sun)
    azimuth, altitude = math.radians(SUN_AZIMUTH_DEG), math.radians(SUN_ALTITUDE_DEG)
    toward = (math.sin(azimuth) * math.cos(altitude), math.cos(azimuth) * math.cos(altitude), math.sin(altitude))
    lamp.rotation_euler = mathutils.Vector(toward).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(lamp)
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    sky = scene.world.node_tree.nodes["Background"]
    sky.inputs[0].default_value, sky.inputs[1].default_value = (0.72, 0.82, 1.0, 1), 0.65
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle, lens.clip_end, lens.clip_start = "VERTICAL", math.radians(float(job["fov"])), 1e5, 0.001
    camera = bpy.data.objects.new("camera", lens)
    camera.location = mathutils.Vector((job["eye"] / UNIT_M).tolist())
    camera.rotation_euler = (-mathutils.Vector(job["forward"].tolist())).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.max_bounces = "CPU", 32, True, 3
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = (int(side) for side in job["size"])
    scene.render.filepath, scene.render.image_settings.file_format = str(out), "PNG"
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
