#!/usr/bin/python3
"""Traces one arm with dolfinx, tuned as its users would: run by peer_dolfinx, which writes the case and reads the answer.

The case (JSON) names vertices, cells and densities of a regular grid (NPZ), moduli, pin, driven face, travels, element
order, solver and predictor. Compiled forms, matrix, symbolic factorization and vectors are kept for the whole curve.
"""
import json
import pathlib
import sys
import time

import numpy as np

import dolfinx
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

JIT = {"cffi_extra_compile_args": ["-O3", "-march=native"]}
ORDERINGS = {"amd": 0, "scotch": 3, "pord": 4, "metis": 5}


class Arm:
    """Mesh, forms, constraints and solver of one case."""

    def __init__(self, case):
        self.case = case
        data = np.load(case["grid"])
        self.dim = case["dimension"]
        shape = {2: "quadrilateral", 3: "hexahedron"}[self.dim]
        domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.Cell(shape, geometric_dimension=self.dim), 1))
        points = np.ascontiguousarray(data["points"][:, :self.dim])
        self.mesh = mesh.create_mesh(MPI.COMM_SELF, data["cells"].astype(np.int64), points, domain)
        order = self.mesh.topology.original_cell_index
        self.space = fem.VectorFunctionSpace(self.mesh, ("Lagrange", case["order"]))
        self.u = fem.Function(self.space)
        cellwise = fem.FunctionSpace(self.mesh, ("DG", 0))
        self.stiffness, self.mix = fem.Function(cellwise), fem.Function(cellwise)
        self.stiffness.x.array[:] = data["stiffness"][order]
        self.mix.x.array[:] = data["mix"][order]
        self.make_forms()
        self.constrain()
        self.make_solver()
        self.seconds = {"residual": 0.0, "matrix": 0.0, "factorization": 0.0, "solve": 0.0}
        self.iterations = 0

    def make_forms(self):
        """s [W_h(I + g H) + (1 - g^2) W_l(H)], its volumetric part on one point fewer per axis if the case says so."""
        mu, lam = self.case["mu"], self.case["lambda"]
        v, du = ufl.TestFunction(self.space), ufl.TrialFunction(self.space)
        h = ufl.grad(self.u)
        eye = ufl.Identity(self.dim)
        mixed = eye + self.mix * h
        log_j = ufl.ln(ufl.det(mixed))
        rest = 1 - self.mix**2
        sym = h + h.T
        shear = (mu / 2 * (ufl.inner(mixed, mixed) - self.dim) - mu * log_j) + rest * mu / 4 * ufl.inner(sym, sym)
        volume = lam / 2 * log_j**2 + rest * lam / 2 * ufl.tr(h)**2
        full = 2 * self.case["order"] + 1
        reduced = full - 2 if self.case["reduced"] else full
        # One form per rule: forms that mix rules with one point and more are compiled wrongly by this version of ffcx.
        energies = [self.stiffness * shear * ufl.dx(metadata={"quadrature_degree": full}),
                    self.stiffness * volume * ufl.dx(metadata={"quadrature_degree": reduced})]
        if reduced == full:
            energies = [sum(energies[1:], energies[0])]
        gradients = [ufl.derivative(energy, self.u, v) for energy in energies]
        self.residual_forms = [fem.form(g, jit_params=JIT) for g in gradients]
        self.matrix_forms = [fem.form(ufl.derivative(g, self.u, du), jit_params=JIT) for g in gradients]

    def constrain(self):
        """The driven face and the mirror plane by boundary conditions; a pin off the nodes by a stiff line spring."""
        case, dim = self.case, self.dim
        x = self.space.tabulate_dof_coordinates()
        eps = 1e-9
        low, high = case["face_y"]
        face = np.where((np.abs(x[:, 0]) < eps) & (x[:, 1] > low - eps) & (x[:, 1] < high + eps))[0]
        held = [dim * face + a for a in range(dim)]
        self.driven = dim * face + 1
        if dim == 3:
            held.append(dim * np.where(np.abs(x[:, 2]) < eps)[0] + 2)
        pin = np.array(case["pin"])
        at_pin = np.where(np.linalg.norm(x[:, :2] - pin, axis=1) < eps)[0]
        self.springs = []
        if len(at_pin):
            held += [dim * at_pin, dim * at_pin + 1]
        else:
            self.springs = self.pin_lines(x, pin)
        self.held = np.unique(np.concatenate(held)).astype(np.int32)
        self.bcs = []
        for a in range(dim):
            self.bcs.append(fem.dirichletbc(PETSc.ScalarType(0), self.held[self.held % dim == a], self.space.sub(a)))

    def pin_lines(self, x, pin):
        """(blocks, weights) of the displacement at the pin, one per layer of nodes along z."""
        h = self.case["cell_size"]
        low = np.floor(pin / h + 1e-9) * h
        near = np.where(np.all((x[:, :2] > low - 1e-9) & (x[:, :2] < low + h + 1e-9), axis=1))[0]
        lines = []
        for z in np.unique(np.round(x[near, 2], 9)):
            blocks = near[np.abs(x[near, 2] - z) < 1e-8]
            weights = np.ones(len(blocks))
            for a in range(2):
                nodes = np.unique(np.round(x[blocks, a], 9))
                for k, block in enumerate(blocks):
                    mine = np.argmin(np.abs(nodes - x[block, a]))
                    for other in range(len(nodes)):
                        if other != mine:
                            weights[k] *= (pin[a] - nodes[other]) / (nodes[mine] - nodes[other])
            lines.append((blocks, weights))
        return lines

    def make_solver(self):
        begin = time.process_time()
        self.b = fem.petsc.create_vector(self.residual_forms[0])
        self.du = self.b.duplicate()
        self.a = fem.petsc.create_matrix(self.matrix_forms[0])
        self.a.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self.a.setOption(PETSc.Mat.Option.SPD, self.case["spd"])
        self.ksp = PETSc.KSP().create(MPI.COMM_SELF)
        self.ksp.setOperators(self.a)
        self.ksp.setType("preonly")
        pc = self.ksp.getPC()
        pc.setType("cholesky")
        pc.setFactorSolverType(self.case["solver"])
        options = PETSc.Options()
        if self.case["solver"] == "mumps":
            options["mat_mumps_icntl_7"] = ORDERINGS[self.case["ordering"]]
        self.ksp.setFromOptions()
        self.setup_seconds = time.process_time() - begin

    def evaluate(self):
        begin = time.process_time()
        with self.b.localForm() as local:
            local.set(0)
        for form in self.residual_forms:
            fem.petsc.assemble_vector(self.b, form)
        r = self.b.array
        u = self.u.x.array
        for blocks, weights in self.springs:
            for a in range(2):
                dofs = self.dim * blocks + a
                r[dofs] += self.case["penalty"] * weights * np.dot(weights, u[dofs])
        force = -r[self.driven].sum()
        r[self.held] = 0
        self.seconds["residual"] += time.process_time() - begin
        return force, np.linalg.norm(r)

    def step(self, count=True):
        begin = time.process_time()
        self.a.zeroEntries()
        for form in self.matrix_forms:
            fem.petsc.assemble_matrix(self.a, form, bcs=self.bcs)
            self.a.assemble()
        for blocks, weights in self.springs:
            block = self.case["penalty"] * np.outer(weights, weights)
            for a in range(2):
                dofs = (self.dim * blocks + a).astype(np.int32)
                self.a.setValues(dofs, dofs, block, addv=PETSc.InsertMode.ADD_VALUES)
        self.a.assemble()
        assembled = time.process_time()
        self.ksp.setOperators(self.a)
        self.ksp.setUp()
        factored = time.process_time()
        self.ksp.solve(self.b, self.du)
        self.u.x.array[:] -= self.du.array
        self.iterations += count
        done = time.process_time()
        self.seconds["matrix"] += assembled - begin
        self.seconds["factorization"] += factored - assembled
        self.seconds["solve"] += done - factored

    def drive(self, travel):
        self.u.x.array[self.held] = 0
        self.u.x.array[self.driven] = -travel

    def start(self, travel):
        """Tangent guess of the first step: a moved face alone would invert the cells behind it."""
        move = self.du.duplicate()
        move.array[self.driven] = -travel
        self.a.zeroEntries()
        for form in self.matrix_forms:
            fem.petsc.assemble_matrix(self.a, form)
            self.a.assemble()
        self.a.mult(move, self.b)
        self.b.array[self.held] = 0
        self.step(False)

    def settle(self):
        """Backs off a step that inverted cells."""
        force, norm = self.evaluate()
        share = 1.0
        while not np.isfinite(norm) and share > 1e-3:
            share *= 0.5
            self.u.x.array[:] += share * self.du.array
            force, norm = self.evaluate()
        return force, norm

    def trace(self):
        """Newton from point to point; the guess is the polynomial through the last points (1: secant, 2: parabola)."""
        begin = time.process_time()
        points = []
        past = []
        for travel in self.case["travels"]:
            order = min(self.case["predictor"], len(past) - 1)
            if order == 1:
                self.u.x.array[:] = 2 * past[-1] - past[-2]
            elif order == 2:
                self.u.x.array[:] = 3 * past[-1] - 3 * past[-2] + past[-3]
            if len(past) == 1:
                self.start(travel)
            self.drive(travel)
            self.du.set(0)
            for k in range(self.case["max_iterations"] + 1):
                force, norm = self.settle()
                if not np.isfinite(norm) or k == self.case["max_iterations"]:
                    return {"status": f"failed at {travel}: residual {norm} N after {k} iterations"}
                if norm <= self.case["tolerance"]:
                    break
                self.step()
            points.append([travel, force, k])
            past = (past + [self.u.x.array.copy()])[-3:]
        return {"status": "converged", "points": points, "seconds_total": time.process_time() - begin}


def main():
    case = json.loads(pathlib.Path(sys.argv[1]).read_text())
    begin = time.process_time()
    arm = Arm(case)
    setup = time.process_time() - begin
    result = arm.trace()
    result.update(seconds=arm.seconds, iterations=arm.iterations, dof=int(arm.u.x.array.size - len(arm.held)),
                  seconds_setup=setup, version=dolfinx.__version__, petsc=".".join(map(str, PETSc.Sys.getVersion())))
    print(json.dumps(result))


if __name__ == "__main__":
    main()
