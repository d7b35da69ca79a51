"""Exported materials, judged by the formats' own tools: check_formats.py FORMAT FILE...

Prints a line for each thing that is wrong and ends with 1 where there is one.
"""

import os
import sys

wrong = []


def materialx(path):
    import MaterialX as mx
    from MaterialX import PyMaterialXGenGlsl, PyMaterialXGenOsl, PyMaterialXGenShader

    libraries = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), libraries)
    document = mx.createDocument()
    mx.readFromXmlFile(document, path)
    is_valid, message = document.validate()
    if not is_valid:
        wrong.append(f"{path}: {message}")
    document.setDataLibrary(libraries) if hasattr(document, "setDataLibrary") else document.importLibrary(libraries)
    materials = document.getMaterialNodes()
    if not materials:
        wrong.append(f"{path}: no material")
    for material in materials:
        for shader in mx.getShaderNodes(material):
            definition = shader.getNodeDef()
            if not definition:
                wrong.append(f"{path}: {shader.getName()} has no node definition")
                continue
            for given in shader.getInputs():
                if not definition.getActiveInput(given.getName()):
                    wrong.append(f"{path}: {shader.getCategory()} has no input {given.getName()}")
        for generator in (PyMaterialXGenGlsl.GlslShaderGenerator.create(), PyMaterialXGenOsl.OslShaderGenerator.create()):
            context = PyMaterialXGenShader.GenContext(generator)
            context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
            system = PyMaterialXGenShader.DefaultColorManagementSystem.create(generator.getTarget())
            system.loadLibrary(libraries)
            generator.setColorManagementSystem(system)
            shader = generator.generate(material.getName(), material, context)
            if not shader or len(shader.getSourceCode("pixel")) < 1000:
                wrong.append(f"{path}: no shader for {generator.getTarget()}")


def usd(path):
    from pxr import Usd, UsdShade, UsdValidation

    stage = Usd.Stage.Open(path)
    materials = [UsdShade.Material(prim) for prim in stage.Traverse() if prim.IsA(UsdShade.Material)]
    if not materials:
        wrong.append(f"{path}: no material")
    for material in materials:
        for context in ("", "mtlx"):
            source = material.ComputeSurfaceSource(context)[0]
            if not source or not source.GetPrim():
                wrong.append(f"{path}: {material.GetPath()} has no surface for '{context}'")
        if "glossmith_material" not in material.GetPrim().GetCustomData():
            wrong.append(f"{path}: {material.GetPath()} has lost its exact parameters")
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    for error in UsdValidation.ValidationContext(validators).Validate(stage):
        text = error.GetErrorAsString()
        # This build of USD knows no nodes of MaterialX; those are judged by MaterialX itself.
        is_unknown = "MissingShaderIdInRegistry" in text and "'ND_" in text
        # Bumps that are weakened or upside down are scaled otherwise than plain ones.
        if not (is_unknown or "NormalMapTextureValidator.NonCompliant" in text):
            wrong.append(f"{path}: {text}")


def blender(path):
    """Runs a script with something in Blender's place that has every node, input and output."""
    from unittest.mock import MagicMock, patch

    bpy = MagicMock()
    bpy.data.filepath, bpy.data.texts = "", []
    material = bpy.data.materials.new.return_value
    shader = MagicMock(type="BSDF_PRINCIPLED")
    shader.inputs.__contains__.return_value = True
    material.node_tree.nodes.__iter__.side_effect = lambda: iter([shader])
    with patch.dict(sys.modules, bpy=bpy), open(path) as file:
        exec(compile(file.read(), path, "exec"), {"__file__": path})
    for loaded in bpy.data.images.load.call_args_list:
        if not os.path.isfile(loaded.args[0]):
            wrong.append(f"{path}: no image {loaded.args[0]}")
    print(path, len(bpy.data.images.load.call_args_list))


def mitsuba(path, spp=1):
    """Prints the means of the quarters of the middle of the ball in even light, by channel."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    scene = mi.load_file(path)
    picture = mi.render(scene, spp=spp, seed=1)
    height, width, channels = picture.shape
    numbers = list(picture.array)
    if not all(x >= 0 for x in numbers):
        wrong.append(f"{path}: darker than black")
    means = []
    for top, left in ((3, 3), (3, 4), (4, 3), (4, 4)):
        rows = range(top * height // 8, (top + 1) * height // 8)
        columns = range(left * width // 8, (left + 1) * width // 8)
        quarter = [(y * width + x) * channels for y in rows for x in columns]
        means += (sum(numbers[at + channel] for at in quarter) / len(quarter) for channel in range(3))
    print(path, *(f"{x:.5f}" for x in means))


def mitsuba_means(path):
    mitsuba(path, spp=64)


def mitsuba_lobe(path):
    """Prints how far the lobe is, as a total variation seen along the normal, from the table of the same name (.csv)."""
    import csv
    import math

    import drjit as dr
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    bsdf = mi.load_file(path).shapes()[0].bsdf()
    seen = dr.zeros(mi.SurfaceInteraction3f)
    seen.wi = mi.Vector3f(0, 0, 1)
    with open(path.removesuffix("xml") + "csv") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        rows = [row for row in rows if row["view_deg"] == "0"]
    theirs, ours = [], []
    for row in rows:
        light, azimuth = math.radians(float(row["light_deg"])), math.radians(float(row["light_azimuth_deg"]))
        sine = math.sin(light)
        towards = mi.Vector3f(sine * math.cos(azimuth), sine * math.sin(azimuth), math.cos(light))
        theirs.append(sine * sum(bsdf.eval(mi.BSDFContext(), seen, towards)))
        ours.append(sine * float(row["value"]))
    apart = zip(theirs, ours)
    print(path, 0.5 * sum(abs(a / sum(theirs) - b / sum(ours)) for a, b in apart))


for name in sys.argv[2:]:
    globals()[sys.argv[1].replace("-", "_")](name)
print("\n".join(wrong))
sys.exit(bool(wrong))
