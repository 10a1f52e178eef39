"""The rows of a Saltelli block, and what they have in common.

A block of k columns has the rows A, AB_1 .. AB_k, (BA_1 .. BA_k,) B. AB_j is A with column j from B. A set of columns
is written as a number whose bit j stands for column j.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np


def draw(blocks: int, groups: Sequence[int], second_order: bool, seed: int) -> np.ndarray:
    """Draw the rows of Saltelli's design in the unit cube.

    SALib draws the same rows, one number at a time: a million rows take seconds there.

    Parameters
    ----------
    blocks : number of blocks, a power of two
    groups : group 0, 1, ... of each column; the columns of a group are exchanged together
    second_order : whether the blocks have the rows BA_j
    seed : seed of the scrambled Sobol sequence

    Returns
    -------
    (blocks x rows of a block, number of columns) quantiles
    """
    from scipy.stats import qmc  # heavy, and a plan of a grid does not need it

    k, exchanged = len(groups), max(groups) + 1
    base = qmc.Sobol(d=2 * k, seed=seed).random(blocks)  # `seed`, as SALib has it: `rng` scrambles in another way
    a, b = base[:, :k], base[:, k:]
    rows = np.repeat(a[:, None], (2 * exchanged if second_order else exchanged) + 2, axis=1)
    rows[:, 1 + exchanged :] = b[:, None]  # the rows BA_j and B
    for column, group in enumerate(groups):
        rows[:, 1 + group, column] = b[:, column]
        if second_order:
            rows[:, 1 + exchanged + group, column] = a[:, column]
    return rows.reshape(-1, k)


def pairs_sharing(count: int, second_order: bool) -> dict[int, list[tuple[int, int]]]:
    """Return the pairs of rows of a block by the columns that both rows share.

    Parameters
    ----------
    count : number of columns k
    second_order : whether the block has the rows BA_j

    Returns
    -------
    Set of columns -> pairs (row, row) with equal values in these columns and in no other. If pairs with A or with B are
    among them, only these pairs are returned, because A and B give them the best control variate.
    """
    whole = (1 << count) - 1
    from_a = [whole, *(whole ^ (1 << j) for j in range(count))]
    from_a += [*(1 << j for j in range(count)), 0] if second_order else [0]
    last = len(from_a) - 1
    sharing: dict[int, list[tuple[int, int]]] = {}
    for i, one in enumerate(from_a):
        for j in range(i):
            sharing.setdefault(whole ^ one ^ from_a[j], []).append((j, i))
    ends = {columns: [pair for pair in pairs if pair[0] == 0 or pair[1] == last] for columns, pairs in sharing.items()}
    return {columns: ends[columns] or pairs for columns, pairs in sharing.items()}


def all_groups(groups: Mapping[str, Sequence[str]], factors: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return the groups of a study file and, after these, each factor in no group as a group of its own name."""
    taken = {name for members in groups.values() for name in members}
    return {name: tuple(members) for name, members in groups.items()} | {
        name: (name,) for name in factors if name not in taken
    }
