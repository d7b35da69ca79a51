"""Exported materials, judged by the formats' own tools: check_formats.py FORMAT FILE...

Prints a line for each thing that is wrong and ends with 1 where there is one.
"""

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
    from pxr import Usd, UsdShade, UsdUtils

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
    checker = UsdUtils.ComplianceChecker(arkit=False, skipARKitRootLayerCheck=True)
    checker.CheckCompliance(path)
    wrong.extend(f"{path}: {text}" for text in checker.GetErrors() + checker.GetFailedChecks())


def mitsuba(path):
    """The mean of the middle of the ball in even light, by channel."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    scene = mi.load_file(path, spp=64)
    picture = mi.render(scene, spp=64, seed=1).numpy()
    if not (picture[..., :3] >= 0).all():
        wrong.append(f"{path}: darker than black")
    middle = picture[96:160, 96:160, :3].mean(axis=(0, 1))
    print(path, *(f"{x:.5f}" for x in middle))


for name in sys.argv[2:]:
    {"materialx": materialx, "usd": usd, "mitsuba": mitsuba}[sys.argv[1]](name)
print("\n".join(wrong))
sys.exit(bool(wrong))
