#!/usr/bin/env python3
"""VTK, the library under ParaView, reads the tetrahedra of an export: their volumes, displacements and tensors.

Volumes by VTK's own mesh quality filter are positive and sum to that of the barrel; VTK's gradient of the displacement gives the Green
strain that the file states, and its von Mises stress that of the stated tensor.
"""
import json
import os

import client


def main():
    python = client.need_python("vtkmodules.vtkIOXML")
    with client.work_folder() as folder:
        shot = client.make_shot(folder)
        client.export(shot, folder, "vtu")
        print(client.run_program([python, os.path.join(client.HERE, "vtk_reads.py"), folder]).strip())


if __name__ == "__main__":
    main()
