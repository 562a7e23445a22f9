"""Runs in a Python that has VTK: reads the proof's tetrahedra with VTK and compares what VTK computes with what the files state."""
import os
import sys

from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersGeneral import vtkCellDerivatives
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

FRAMES = range(1, 6)
TETRA = 10
TENSOR = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # VTK's order of six components


def check(condition, what):
    if not condition:
        sys.exit("the client disagrees: %s" % what)


def read(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def volumes(grid):
    sizes = vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    array = sizes.GetOutput().GetCellData().GetArray("Volume")
    return [array.GetValue(e) for e in range(grid.GetNumberOfCells())]


def displacement_gradients(grid):
    """du/dx of each element, in the deformed shape, [i][j] = du_i / dx_j."""
    grid.GetPointData().SetActiveVectors("displacement")
    derivatives = vtkCellDerivatives()
    derivatives.SetInputData(grid)
    derivatives.SetTensorModeToComputeGradient()
    derivatives.Update()
    array = derivatives.GetOutput().GetCellData().GetTensors()
    return [[array.GetTuple9(e)[3 * i:3 * i + 3] for i in range(3)] for e in range(grid.GetNumberOfCells())]


def inverse(m):
    (a, b, c), (d, e, f), (g, h, i) = m
    det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    rows = ((e * i - f * h, c * h - b * i, b * f - c * e), (f * g - d * i, a * i - c * g, c * d - a * f),
            (d * h - e * g, b * g - a * h, a * e - b * d))
    return [[x / det for x in row] for row in rows]


def green(gradient):
    """(F^T F - I) / 2 from du/dx: F^-1 = I - du/dx."""
    F = inverse([[(i == j) - gradient[i][j] for j in range(3)] for i in range(3)])
    return [(sum(F[k][i] * F[k][j] for k in range(3)) - (i == j)) / 2 for i, j in TENSOR]


def von_mises(s):
    xx, yy, zz, xy, yz, xz = s
    return (((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy * xy + yz * yz + xz * xz)) ** 0.5


def check_frame(grid, frame):
    data = grid.GetCellData()
    count = grid.GetNumberOfCells()
    check(all(grid.GetCellType(e) == TETRA for e in range(count)), "frame %d has cells that are no tetrahedra" % frame)
    check(min(volumes(grid)) > 0, "frame %d has a volume of %g" % (frame, min(volumes(grid))))
    stated, stress = data.GetArray("green_strain"), data.GetArray("cauchy_stress")
    mises = data.GetArray("cauchy_von_mises")
    check(stated.GetComponentName(3) == "XY", "the components of tensors have no names")
    largest = 0.0
    for e, gradient in enumerate(displacement_gradients(grid)):
        strain = green(gradient)
        largest = max([largest] + [abs(x) for x in strain])
        for k in range(6):
            check(abs(strain[k] - stated.GetComponent(e, k)) < 2e-6,
                  "frame %d, element %d: Green strain %r instead of %r" % (frame, e, stated.GetTuple(e), strain))
        expected = von_mises(stress.GetTuple(e))
        check(abs(mises.GetValue(e) - expected) <= 2e-6 * max(expected, 1), "frame %d, element %d: von Mises stress" % (frame, e))
    return largest


def main():
    folder = sys.argv[1]
    grids = [read(os.path.join(folder, "barrel.barrel.%04d.vtu" % frame)) for frame in FRAMES]
    strains = [check_frame(grid, frame) for frame, grid in zip(FRAMES, grids)]
    check(strains[0] < 1e-9 and strains[-1] > 0.05, "strains of the frames: %r" % strains)
    total = sum(volumes(grids[0]))
    # The integral of (0.2 + 0.07 sin(pi h))^2 over the height, times 3: the area of a regular 12-gon of radius 1.
    check(abs(total / 0.1808 - 1) < 0.05, "volume %g" % total)
    print("VTK %s: %d frames of %d tetrahedra, Green strain up to %.3f" %
          (vtkVersion.GetVTKVersion(), len(grids), grids[0].GetNumberOfCells(), strains[-1]))


main()
