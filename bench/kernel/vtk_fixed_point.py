#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders what bench_kernel rendered with VTK's vtkFixedPointVolumeRayCastMapper, side by side.

    build/release/bench_kernel > ours.json
    xvfb-run -a python3 bench/kernel/vtk_fixed_point.py ours.json

Same scene, camera, size, step and number of threads; one ray per pixel. VTK's time is that of
Render() with a changed camera; its one-time preparation (gradients, min-max cells) is left out.
With --pictures PREFIX on both sides the pictures are compared too.
"""
import json
import statistics
import sys
import time

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkNIFTIImageReader
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow,
                                         vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers the window)

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


def picture_of(window):
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.Update()
    data = grab.GetOutput()
    width, height, _ = data.GetDimensions()
    pixels = vtk_to_numpy(data.GetPointData().GetScalars()).reshape(height, width, -1)
    return pixels[::-1, :, :3].astype(float)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        ours = json.load(file)
    prefix = sys.argv[sys.argv.index("--pictures") + 1] if "--pictures" in sys.argv else None
    parts = []
    for mode in ["unlit", "shaded", "mip"]:
        window, camera = build(ours, mode)
        window.Render()
        seconds = []
        for _ in range(REPEATS):
            camera.Modified()
            start = time.perf_counter()
            window.Render()
            seconds.append(time.perf_counter() - start)
        theirs = statistics.median(seconds)
        mine = ours[mode]["median"]
        part = f"{mode} {theirs / mine:.1f}x (VTK {theirs * 1e3:.1f} ms, ours {mine * 1e3:.1f} ms)"
        if prefix:
            size = ours["size"]
            raw = numpy.fromfile(f"{prefix}{mode}.rgb32f", dtype=numpy.float32)
            mine8 = numpy.clip(raw.reshape(size, size, 3) * 255, 0, 255)
            part += f" rms {numpy.sqrt(numpy.mean((picture_of(window) - mine8) ** 2)):.2f}/255"
        parts.append(part)
    print(f"VTK / ours, {ours['threads']} threads, step {ours['step']}: " + "; ".join(parts))


if __name__ == "__main__":
    main()
