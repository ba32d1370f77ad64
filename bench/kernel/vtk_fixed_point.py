#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders what bench_kernel rendered with VTK's vtkFixedPointVolumeRayCastMapper, side by side.

    build/release/bench_kernel > ours.json
    xvfb-run -a python3 bench/kernel/vtk_fixed_point.py ours.json

Same scene, camera, size, step and number of threads; one ray per pixel. VTK's time is that of
Render() with a changed camera; its one-time preparation (gradients, min-max cells) is left out.
The ratio of processor times is the one to trust on a machine that others use too.
With --pictures PREFIX on both sides the pictures are compared too.
"""
import array
import json
import statistics
import sys
import time

from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkNIFTIImageReader
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow,
                                         vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers the window)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401  (registers how the picture is shown)

REPEATS = 7


def build(ours, mode):
    reader = vtkNIFTIImageReader()
    reader.SetFileName(ours["file"])
    reader.Update()
    image = reader.GetOutput()
    image.SetOrigin(0, 0, 0)
    mapper = vtkFixedPointVolumeRayCastMapper()
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetSampleDistance(ours["step"])
    mapper.SetImageSampleDistance(1)
    mapper.SetNumberOfThreads(ours["threads"])
    if mode == "mip":
        mapper.SetBlendModeToMaximumIntensity()
    color, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    for node in [(0, 0, 0, 0), (60, .8, .4, .3), (120, .95, .9, .8), (255, 1, 1, 1)]:
        color.AddRGBPoint(*node)
    for value, alpha in [(0, 0), (30, 0), (60, .02), (120, .15), (255, .4)]:
        opacity.AddPoint(value, 1 if mode == "mip" else alpha)
    look = vtkVolumeProperty()
    look.SetColor(color)
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(1)
    look.SetInterpolationTypeToLinear()
    if mode == "shaded":
        look.ShadeOn()
        look.SetAmbient(.2)
        look.SetDiffuse(.7)
        look.SetSpecular(.2)
        look.SetSpecularPower(20)
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look)
    renderer = vtkRenderer()
    renderer.AddVolume(volume)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(ours["size"], ours["size"])
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*ours["position"])
    camera.SetFocalPoint(*ours["target"])
    camera.SetViewUp(*ours["up"])
    camera.SetViewAngle(ours["fovy"])
    renderer.ResetCameraClippingRange()
    return window, camera


def distance(window, ours_file, size):
    """RMS of the channels, in 1/255; VTK's rows run from the bottom."""
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.Update()
    theirs = bytes(memoryview(grab.GetOutput().GetPointData().GetScalars()))
    ours = array.array("f")
    with open(ours_file, "rb") as file:
        ours.fromfile(file, size * size * 3)
    total = 0.0
    for row in range(size):
        bottom = (size - 1 - row) * size * 3
        for i in range(size * 3):
            mine = min(max(ours[row * size * 3 + i] * 255, 0), 255)
            total += (theirs[bottom + i] - mine) ** 2
    return (total / (size * size * 3)) ** .5


def frame_times(window, camera):
    """Medians of wall and processor time of a frame."""
    wall, processor = [], []
    for _ in range(REPEATS):
        camera.Modified()
        start, start_processor = time.perf_counter(), time.process_time()
        window.Render()
        wall.append(time.perf_counter() - start)
        processor.append(time.process_time() - start_processor)
    return statistics.median(wall), statistics.median(processor)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        ours = json.load(file)
    prefix = sys.argv[sys.argv.index("--pictures") + 1] if "--pictures" in sys.argv else None
    parts = []
    for mode in ["unlit", "shaded", "mip"]:
        window, camera = build(ours, mode)
        window.Render()
        wall, processor = frame_times(window, camera)
        mine = ours[mode]
        part = (f"{mode} {wall / mine['median']:.1f}x wall, {processor / mine['cpu']:.1f}x processor "
                f"(VTK {wall * 1e3:.0f} ms, ours {mine['median'] * 1e3:.0f} ms)")
        if prefix:
            file = f"{prefix}{mode}.rgb32f"
            part += f" apart by rms {distance(window, file, ours['size']):.2f}/255"
        parts.append(part)
    print(f"VTK / ours, {ours['threads']} threads, step {ours['step']}: " + "; ".join(parts))


if __name__ == "__main__":
    main()
