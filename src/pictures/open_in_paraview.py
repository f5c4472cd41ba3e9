"""Opens a run in ParaView: liquid as dots of the size of the finest particles, coloured by speed; solids and walls in
grey; the surface of `make mesh`, if there is one; the time. A plane scene is seen from the front, others with z up.

In ParaView: Macros, Import new macro, this file; open snapshots.xdmf with the "Xdmf3 Reader S" (do not press
Apply), and press the macro's button. In a shell: pvpython open_in_paraview.py RUN [PICTURE.png [TIME]], with
the folder of a run. With PICTURE.png it writes a picture of the last time, or of TIME (s); else it shows a window until
you close that."""
import glob
import json
import os
import sys

from paraview import simple

SIZE = [1200, 800]  # pixels of a picture


def spacing(folder):
    """The particle spacing (m) of the run."""
    with open(os.path.join(folder, "scene.json"), encoding="utf-8") as file:
        return json.load(file)["domain"]["spacing"]


def dots(source, view, diameter):
    display = simple.Show(source, view)
    display.SetRepresentationType("Point Gaussian")
    display.GaussianRadius = 0.5 * diameter
    display.ShaderPreset = "Sphere"
    return display


def part(reader, view, diameter, low, high):
    """The particles whose body is between two numbers: 0, 1, ... is liquid, -1 walls, less are solids."""
    some = simple.Threshold(Input=reader)
    some.Scalars = ["POINTS", "body"]
    some.LowerThreshold, some.UpperThreshold, some.ThresholdMethod = low, high, "Between"
    return dots(some, view, diameter)


def look(reader, view):
    """Sets a camera that sees all from the front: along y with z up; a plane scene along z."""
    x0, x1, y0, y1, z0, z1 = reader.GetDataInformation().GetBounds()
    middle = [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2]
    away = 2 * max(x1 - x0, y1 - y0, z1 - z0)
    plane = z1 - z0 < 1e-9 * away
    view.CameraParallelProjection = int(plane)
    view.CameraFocalPoint = middle
    view.CameraViewUp = [0, 1, 0] if plane else [0, 0, 1]
    view.CameraPosition = ([middle[0], middle[1], middle[2] + away] if plane
                           else [middle[0] - 0.3 * away, middle[1] - away, middle[2] + 0.3 * away])
    simple.ResetCamera(view)
    if plane:  # ResetCamera leaves room for a sphere
        wide, high = view.ViewSize
        view.CameraParallelScale = 0.6 * max(y1 - y0, (x1 - x0) * high / wide)


def show(reader, folder, time=None):
    """Shows the run that a reader of its snapshots.xdmf has; returns the view."""
    reader.UpdatePipeline()
    times, diameter = list(reader.TimestepValues), spacing(folder)
    view = simple.GetActiveViewOrCreate("RenderView")
    view.ViewTime = times[-1] if time is None else min(times, key=lambda t: abs(t - time))
    simple.GetAnimationScene().AnimationTime = view.ViewTime
    reader.UpdatePipeline(view.ViewTime)
    simple.Hide(reader, view)
    liquid = part(reader, view, diameter, 0, 1e9)
    simple.ColorBy(liquid, ("POINTS", "velocity", "Magnitude"))
    liquid.RescaleTransferFunctionToDataRange(False)
    liquid.SetScalarBarVisibility(view, True)
    solid = part(reader, view, diameter, -1e9, -1)
    simple.ColorBy(solid, None)
    solid.DiffuseColor = solid.AmbientColor = [0.6, 0.6, 0.6]
    surface = glob.glob(os.path.join(folder, "mesh", "surface.pvd"))
    if surface:
        mesh = simple.Show(simple.PVDReader(FileName=surface[0]), view)
        mesh.Opacity = 0.4
    clock = simple.AnnotateTimeFilter(Input=reader)
    clock.Format = "{time:.4g} s"
    simple.Show(clock, view)
    look(reader, view)
    simple.Render(view)
    return view


def main(words):
    source = simple.GetActiveSource()
    if words:
        folder = words[0]
        source = simple.Xdmf3ReaderS(FileName=[os.path.join(folder, "snapshots.xdmf")])
    elif source:
        folder = os.path.dirname(str(list(source.FileName)[0]))
    else:
        raise RuntimeError("open snapshots.xdmf of a run first, or name its folder: pvpython open_in_paraview.py RUN")
    if len(words) > 1:
        simple.GetActiveViewOrCreate("RenderView").ViewSize = SIZE
    view = show(source, folder, float(words[2]) if len(words) > 2 else None)
    if len(words) > 1:
        simple.SaveScreenshot(words[1], view, ImageResolution=SIZE)
    elif words:
        simple.Interact(view)


if __name__ in ("__main__", "__vtkconsole__"):
    main(sys.argv[1:])
