#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""VTK as a peer of `goldthread bench error`.

    vtk_peer.py JOB                        answers commands on stdin, one JSON object to a line
    vtk_peer.py JOB --first-picture FILE   reads the data, renders once, writes a PNG, ends

JOB is a JSON file that the bench writes: the volume as a raw file, camera, transfer function. Direct
volume rendering and mip are vtkFixedPointVolumeRayCastMapper's, one ray per pixel; surfaces are
vtkFlyingEdges3D's triangles, drawn by OpenGL in software. Commands:

    {"command": "about"}                                        {"version": …, "backend": …}
    {"command": "frame", "look": "unlit", "step": 0.5, "size": [512, 512]}    {"seconds": …}
    {"command": "picture", "look": …, "step": …, "size": …, "file": …}        {"file": …}: writes a PNG
    {"command": "isovalue", "value": 81, "back": 80}            {"seconds": …}: from new value to picture
"""
import json
import sys
import time

from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
from vtkmodules.vtkIOImage import vtkImageReader2, vtkNIFTIImageReader, vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkColorTransferFunction, vtkLight,
                                         vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkVolume,
                                         vtkVolumeProperty, vtkWindowToImageFilter)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers the window)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401  (registers how a volume is shown)

SCALAR_SETTERS = {
    "uint8": "SetDataScalarTypeToUnsignedChar",
    "int8": "SetDataScalarTypeToSignedChar",
    "uint16": "SetDataScalarTypeToUnsignedShort",
    "int16": "SetDataScalarTypeToShort",
    "float32": "SetDataScalarTypeToFloat",
}


def read_volume(job, from_original):
    """The image, its origin at 0: the job's camera is given in the grid's own frame."""
    volume = job["volume"]
    if from_original and volume["original"].endswith((".nii", ".nii.gz")):
        reader = vtkNIFTIImageReader()
        reader.SetFileName(volume["original"])
        reader.Update()
        image = reader.GetOutput()
        image.SetOrigin(0, 0, 0)
        return image
    reader = vtkImageReader2()
    reader.SetFileName(volume["file"])
    getattr(reader, SCALAR_SETTERS[volume["type"]])()
    reader.SetDataByteOrderToLittleEndian()
    reader.SetFileDimensionality(3)
    reader.FileLowerLeftOn()  # the file's first row is y = 0
    width, height, depth = volume["size"]
    reader.SetDataExtent(0, width - 1, 0, height - 1, 0, depth - 1)
    reader.SetDataSpacing(*volume["spacing"])
    reader.Update()
    return reader.GetOutput()


def headlight():
    """As VTK would make it, but with an ambient colour: volumes are dark without, whatever their material."""
    light = vtkLight()
    light.SetLightTypeToHeadlight()
    light.SetAmbientColor(1, 1, 1)
    return light


def blinn_power(job):
    """VTK's highlight of a headlight falls off with the angle of normal and light, Phong's with twice that
    angle: cos(2a)^n is cos(a)^(4n) for small a."""
    return 4 * job["shading"]["shininess"]


class Window:
    """An off-screen window with the job's camera."""

    def __init__(self, job):
        self.renderer = vtkRenderer()
        self.renderer.SetBackground(*job["background"])
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*job["imageSize"])
        self.window.AddRenderer(self.renderer)
        self.renderer.AddLight(headlight())
        self.camera = self.renderer.GetActiveCamera()
        self.camera.SetPosition(*job["camera"]["position"])
        self.camera.SetFocalPoint(*job["camera"]["target"])
        self.camera.SetViewUp(*job["camera"]["up"])
        self.camera.SetViewAngle(job["camera"]["fovy"])

    def set_size(self, size):
        if tuple(size) == tuple(self.window.GetSize()):
            return
        self.window.SetSize(*size)
        self.render()

    def render(self):
        self.window.Render()

    def write(self, file):
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        writer = vtkPNGWriter()
        writer.SetInputConnection(grab.GetOutputPort())
        writer.SetFileName(file)
        writer.Write()


class VolumeView(Window):
    def __init__(self, job, image, look):
        super().__init__(job)
        self.mapper = vtkFixedPointVolumeRayCastMapper()
        self.mapper.SetInputData(image)
        self.mapper.SetAutoAdjustSampleDistances(0)
        self.mapper.SetImageSampleDistance(1)
        self.mapper.SetNumberOfThreads(job["threads"])
        if look == "mip":
            self.mapper.SetBlendModeToMaximumIntensity()
        volume = vtkVolume()
        volume.SetMapper(self.mapper)
        volume.SetProperty(self.material(job, look))
        self.renderer.AddVolume(volume)
        self.renderer.ResetCameraClippingRange()

    @staticmethod
    def material(job, look):
        color, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
        for value, red, green, blue in job["color"]:
            color.AddRGBPoint(value, red, green, blue)
        for value, alpha in job["opacity"]:
            opacity.AddPoint(value, 1 if look == "mip" else alpha)
        material = vtkVolumeProperty()
        material.SetColor(color)
        material.SetScalarOpacity(opacity)
        material.SetScalarOpacityUnitDistance(job["unitDistance"])
        material.SetInterpolationTypeToLinear()
        if look == "Phong":
            material.ShadeOn()
            material.SetAmbient(job["shading"]["ambient"])
            material.SetDiffuse(job["shading"]["diffuse"])
            material.SetSpecular(job["shading"]["specular"])
            material.SetSpecularPower(blinn_power(job))
        return material

    def set_step(self, step):
        self.mapper.SetSampleDistance(step)


class SurfaceView(Window):
    def __init__(self, job, image):
        super().__init__(job)
        self.contour = vtkFlyingEdges3D()
        self.contour.SetInputData(image)
        self.contour.SetValue(0, job["isosurface"]["value"])
        self.contour.ComputeScalarsOff()
        mapper = vtkPolyDataMapper()
        mapper.SetInputConnection(self.contour.GetOutputPort())
        mapper.ScalarVisibilityOff()
        actor = vtkActor()
        actor.SetMapper(mapper)
        look = actor.GetProperty()
        look.SetInterpolationToPhong()
        look.SetColor(*job["isosurface"]["color"])
        look.SetAmbient(job["shading"]["ambient"])
        look.SetDiffuse(job["shading"]["diffuse"])
        look.SetSpecular(job["shading"]["specular"])
        look.SetSpecularPower(blinn_power(job))
        look.SetSpecularColor(1, 1, 1)
        self.renderer.AddActor(actor)
        self.renderer.ResetCameraClippingRange()

    def change(self, value):
        self.contour.SetValue(0, value)
        self.render()

    def set_step(self, step):
        pass


class Peer:
    def __init__(self, job):
        self.job = job
        self.image = read_volume(job, from_original=False)
        self.views = {}

    def view(self, look):
        """One for each look; the first picture prepares it (gradients, min-max cells, triangles)."""
        if look not in self.views:
            self.views[look] = (SurfaceView(self.job, self.image) if look == "isosurface" else
                                VolumeView(self.job, self.image, look))
            self.views[look].render()
        return self.views[look]

    def about(self, _):
        return {"version": vtkVersion.GetVTKVersion(), "backend": vtkSMPTools.GetBackend()}

    def frame(self, request):
        view = self.view(request["look"])
        view.set_size(request["size"])
        view.set_step(request["step"])
        view.camera.Modified()
        start = time.perf_counter()
        view.render()
        return {"seconds": time.perf_counter() - start}

    def picture(self, request):
        view = self.view(request["look"])
        view.set_size(request["size"])
        view.set_step(request["step"])
        view.camera.Modified()
        view.render()
        view.write(request["file"])
        return {"file": request["file"]}

    def isovalue(self, request):
        view = self.view("isosurface")
        start = time.perf_counter()
        view.change(request["value"])
        seconds = time.perf_counter() - start
        view.change(request["back"])
        return {"seconds": seconds}


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        job = json.load(file)
    vtkSMPTools.Initialize(job["threads"])
    if len(sys.argv) > 3 and sys.argv[2] == "--first-picture":
        view = VolumeView(job, read_volume(job, from_original=True), job["look"])
        view.set_step(job["step"])
        view.render()
        view.write(sys.argv[3])
        return
    peer = Peer(job)
    commands = {"about": peer.about, "frame": peer.frame, "picture": peer.picture,
                "isovalue": peer.isovalue}
    for line in sys.stdin:
        request = json.loads(line)
        print(json.dumps(commands[request["command"]](request)), flush=True)


if __name__ == "__main__":
    main()
