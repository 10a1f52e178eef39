"""Stresses of point loads and corner functions of loaded rectangles. GENERATED: do not edit.

Written by `python -m validation.derivations.kernel_writer`; `validation/derivations/potentials.py`
derives them. Every function returns 36 numbers: A for the loads x, y, z (slowest) and the
components xx, yy, zz, xy, yz, xz, then B in the same order; the stress is A + nu B. Lengths of
corner functions are in units of the grid spacing: FLOOR is the distance below which logarithms stop
growing, which keeps a step of traction finite on its edge.
"""

from math import asinh, atan2, log, sqrt

from trackroller.numerics.compiled import compiled

FLOOR = 1e-10


@compiled
def point_kernel(x, y, z):
    """Return the stresses at (x, y, z) due to unit forces at the origin [1/length^2]."""
    x2, y2, z2 = x * x, y * y, z * z
    R = sqrt(x2 + y2 + z2)
    iR = 1.0 / R if R > 0.0 else 0.0
    S = R + z
    iS = 1.0 / S if S > 0.0 else 0.0
    t0 = iS**2
    t1 = y**2
    t2 = 3.0 * iR**4
    t3 = t1 * t2
    t4 = iR**2
    t5 = t1 * t4
    t6 = t0 * t5
    t7 = iR * t1
    t8 = 2.0 * iS**3 * t7
    t9 = t3 - t6 - t8
    t10 = t0 + t9
    t11 = 3.0 * t4
    t12 = z**2
    t13 = t12 * t2
    t14 = -t11 + t13
    t15 = 0.31830988618379067
    t16 = iR * t15
    t17 = 0.5 * t16
    t18 = t17 * x
    t19 = -t3
    t20 = t4 + t6 + t8
    t21 = -t0 + t20
    t22 = 1.5 * t15
    t23 = iR**5 * t22
    t24 = t12 * t23
    t25 = -t24 * x
    t26 = 3.0 * t0
    t27 = t26 + t9
    t28 = t17 * y
    t29 = t23 * z
    t30 = x * y
    t31 = -t29 * t30
    t32 = t5 - 1.0
    t33 = iR**3 * z
    t34 = t20 - t26
    t35 = -t24 * y
    t36 = z**3
    t37 = t0 * t7
    t38 = iS * t5
    t39 = t3 * z
    t40 = -iS + t37 + t38 + t4 * z
    t41 = iR * iS
    t42 = t15 * t30 * t4
    t43 = t1 * t41
    t44 = 2.0 * t43
    t45 = t16 * x
    t46 = t0 * t45 * (t32 + t44)
    t47 = t16 * y
    t48 = t34 * t47
    load_x = (
        t18 * (t10 + t14),
        t18 * (t19 + t21),
        t25,
        t28 * (t13 + t27 - 4.0 * t4),
        t31,
        t22 * t33 * (t12 * t4 + t32),
    )
    load_y = t28 * (t14 + t27), t28 * (t19 + t34), t35, -t10 * t18, -t1 * t29, t31
    load_z = (
        t17 * (iS - t11 * z + t2 * t36 - t37 - t38 + t39),
        t17 * (-t39 + t40),
        -t23 * t36,
        0.5 * t42 * (t0 - 3.0 * t33 + t41),
        t35,
        t25,
    )
    nu_x = t46, -t21 * t45, 0.0, t48, 0.0, 0.0
    nu_y = t0 * t47 * (t44 + t5 - 3.0), -t48, 0.0, -t46, 0.0, 0.0
    nu_z = t15 * t41 * (t32 + t43), -t16 * t40, 0.0, -iS * t42 * (iR + iS), 0.0, 0.0
    return load_x + load_y + load_z + nu_x + nu_y + nu_z


@compiled
def bilinear_corner(x, y, z):
    """Return the corner function of bilinear tractions; d4/dx2dy2: `point_kernel` [length^2]."""
    x2, y2, z2 = x * x, y * y, z * z
    R = sqrt(x2 + y2 + z2)
    S = R + z
    iS = 1.0 / S if S > 0.0 else 0.0
    P = x2 + z2
    Q = y2 + z2
    Lx = asinh(x / max(sqrt(Q), FLOOR))
    Ly = asinh(y / max(sqrt(P), FLOOR))
    Lz = log(max(S, FLOOR))
    t = x * y * (x2 + y2) * iS
    Ax = atan2(t, x2 * R + y2 * z)
    Ay = atan2(t, y2 * R + x2 * z)
    t0 = Ly * x
    t1 = t0 * y
    t2 = Ax * y
    t3 = t2 * z
    t4 = R * x
    t5 = Lz * x
    t6 = t5 * z
    t7 = t4 - t6
    t8 = z**2
    t9 = Lx * t8
    t10 = y**2
    t11 = Lx * t10
    t12 = Ay * y
    t13 = 2.0 * z
    t14 = t12 * t13
    t15 = -t11 + t14 + t9
    t16 = 0.31830988618379067
    t17 = 0.5 * t16
    t18 = Lx * z
    t19 = t12 + t18
    t20 = t17 * z
    t21 = t20 * (t19 + t2)
    t22 = Ax * z
    t23 = 2.0 * t22 * x
    t24 = R * y
    t25 = x**2
    t26 = Ly * t25
    t27 = Ly * t8
    t28 = Lz * y
    t29 = t28 * z
    t30 = Ay * z
    t31 = t30 * x
    t32 = Lx * y
    t33 = t32 * x
    t34 = t31 - t33
    t35 = t20 * (-t0 + t22 + t30 - t32)
    t36 = t18 * x
    t37 = Ly * z
    t38 = t37 * y
    t39 = 2.0 * t38
    t40 = R * z
    t41 = t2 * x
    t42 = t12 * x
    t43 = t41 + t42
    t44 = -2.0 * t40 + t43
    t45 = Ax * x + t37
    t46 = t24 - t29
    t47 = t23 - t26 + t27
    t48 = t20 * (Ay * x + t45)
    t49 = -t1 + t3
    t50 = 2.0 * t36
    t51 = -1.5 * t40
    t52 = Lz * t25
    t53 = 0.5 * t52
    t54 = Lz * t10
    t55 = 0.5 * t54
    t56 = Ax * t25
    t57 = Ay * t10
    t58 = Ax * t8
    t59 = Ay * t8
    t60 = t5 * y
    t61 = t0 * t13 + 2.0 * t18 * y
    t62 = t17 * (t15 - t4 + 2.0 * t6)
    t63 = t17 * (-t24 + 2.0 * t29 + t47)
    t64 = -t40
    load_x = (
        -t17 * (-2.0 * t1 + t15 + 3.0 * t3 + t7),
        -t20 * (t19 + t5),
        t21,
        -t17 * (t23 + 0.5 * t24 - 0.5 * t26 + 1.5 * t27 + t29 + t34),
        t35,
        -t17 * (t36 + t39 + t44),
    )
    load_y = (
        -t20 * (t28 + t45),
        -t17 * (3.0 * t31 - 2.0 * t33 + t46 + t47),
        t48,
        -t17 * (-0.5 * t11 + t14 + 0.5 * t4 + t49 + t6 + 1.5 * t9),
        -t17 * (t38 + t44 + t50),
        t35,
    )
    load_z = (
        -t17 * (t39 + t41 + t51 - t53 + t55),
        -t17 * (t42 + t50 + t51 + t53 - t55),
        -t17 * (t40 + t43),
        -t17 * (0.5 * t56 + 0.5 * t57 - 1.5 * t58 - 1.5 * t59 + t60 + t61),
        t48,
        t21,
    )
    nu_x = -t62, -t16 * (t49 + t7), 0.0, t63, 0.0, 0.0
    nu_y = -t16 * (t34 + t46), -t63, 0.0, t62, 0.0, 0.0
    nu_z = (
        -t17 * (2.0 * t42 + t50 + t52 - t54 + t64),
        -t17 * (t39 + 2.0 * t41 - t52 + t54 + t64),
        0.0,
        t17 * (t56 + t57 - t58 - t59 + 2.0 * t60 + t61),
        0.0,
        0.0,
    )
    return load_x + load_y + load_z + nu_x + nu_y + nu_z
