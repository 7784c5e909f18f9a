"""Candidate contacts: which disks are near, how pairs are stored as runs, and which of them are closed."""

from __future__ import annotations

import math

import numpy as np

from ..machine.machine_code import kernel

#: Runs with fewer pairs than this are not worth a vector loop of their own.
SHORTEST_RUN = 24
#: Missing pairs bridged to keep a run together; they cost less than a new run.
LONGEST_GAP = 3


def make_runs(first, second, n, longest_gap=LONGEST_GAP, shortest_run=SHORTEST_RUN, multiple=1):
    """Store pairs as runs of constant index difference.

    Parameters
    ----------
    first, second : (m,) int pairs with ``first < second``, each listed once, sorted by ``(first, second)``;
        ``n`` : number of disks; ``longest_gap`` : number of missing pairs bridged inside a run;
        ``shortest_run`` : runs that hold fewer of the pairs are taken apart; ``multiple`` : runs are lengthened to a
        multiple of it where there are disks enough.

    Returns
    -------
    runs : (r, 4) int64 ``first disk, second disk, count, first slot``, single pairs last in their given order;
        ``slot`` : (m,) int64 slot of each given pair. There are ``runs[-1, 2] + runs[-1, 3]`` slots; those of no
        given pair fill gaps and ends, and may belong to a pair that is given elsewhere.
    """
    m = len(first)
    if m == 0:
        return np.zeros((0, 4), np.int64), np.zeros(0, np.int64)
    i, j = first.astype(np.int64), second.astype(np.int64)
    by = np.lexsort((i, j - i))
    a, b = i[by], j[by]
    new = (np.diff(b - a) != 0) | (np.diff(a) > longest_gap + 1)
    begin = np.concatenate([[0], np.flatnonzero(new) + 1])
    members = np.diff(np.concatenate([begin, [m]]))
    alone = np.empty(m, bool)
    shortest_run = max(shortest_run, 2)  # a run of one would stand before the single pairs, which come last
    alone[by] = np.repeat(members < shortest_run, members)
    kept = members >= shortest_run
    begin, members = begin[kept], members[kept]
    i0, j0 = a[begin], b[begin]
    count = a[begin + members - 1] - i0 + 1
    up = np.minimum(-count % multiple, n - j0 - count)
    down = np.minimum((-count - up) % multiple, i0)
    fits = (count + up + down) % multiple == 0
    i0, j0, count = i0 - down * fits, j0 - down * fits, count + (up + down) * fits
    first_slot = np.cumsum(count) - count
    slot = np.empty(m, np.int64)
    which = np.repeat(np.arange(len(begin)), members)
    in_run = by[~alone[by]]
    slot[in_run] = first_slot[which] + i[in_run] - i0[which]
    single = np.flatnonzero(alone)
    slot[single] = int(count.sum()) + np.arange(len(single))
    ones = np.ones(len(single), np.int64)
    runs = np.concatenate(
        [
            np.stack([i0, j0, count, first_slot], axis=1),
            np.stack([i[single], j[single], ones, slot[single]], axis=1),
        ]
    )
    return runs, slot


def run_pairs(runs):
    """The pairs ``(first, second)`` of all slots of the runs, each (slots,) int64."""
    if len(runs) == 0:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    which = np.repeat(np.arange(len(runs)), runs[:, 2])
    along = np.arange(runs[-1, 2] + runs[-1, 3]) - runs[which, 3]
    return runs[which, 0] + along, runs[which, 1] + along


@kernel
def near(along, across, radius, skin, farthest, period, found):
    """Fill ``found`` (room, 2) with the pairs of disks whose gap is less than ``skin``, as far as there is room.

    ``along``, ``across``, ``radius`` (n,) : places, in the order of ``along``; disks farther apart than ``farthest``
    along either are no pair; ``period`` : of ``along``, infinite without one. Returns how many pairs there are: each
    once, in no order.
    """
    n, count = along.size, 0
    for i in range(n):
        # on to the last disk within reach, then those that are so across the period
        for lap in range(2):
            ahead = 0.0 if lap == 0 else period
            for j in range(i + 1 if lap == 0 else 0, n if lap == 0 else i):
                away = along[j] + ahead - along[i]
                if away > farthest:
                    break
                if lap == 1 and along[i] - along[j] <= farthest:
                    continue  # met on the first lap
                aside = across[j] - across[i]
                reach = radius[i] + radius[j] + skin
                if abs(aside) <= farthest:
                    apart = along[i] - along[j]
                    if period < math.inf:
                        apart -= period * np.rint(apart / period)
                    if apart * apart + aside * aside < reach * reach:
                        if count < found.shape[0]:
                            found[count, 0], found[count, 1] = i, j
                        count += 1
            if period == math.inf:
                break
    return count


@kernel
def mark_closed(q, n, separation, reach, slot, pairs, walls, closed):
    """Fill ``closed``: which listed pairs overlap, then which listed wall contacts do.

    ``separation`` (2, slots), ``reach`` (slots,): separations when the list was made and sums of radii, ``slot`` (m,)
    those of the listed ``pairs`` (first and second disks); ``walls``: disks, normals, and gaps at that time; ``q`` :
    displacements since.
    """
    first, second = pairs
    wall_disk, wall_normal, wall_gap = walls
    for k in range(len(first)):
        i, j, s = first[k], second[k], slot[k]
        x = separation[0, s] + (q[i] - q[j])
        z = separation[1, s] + (q[n + i] - q[n + j])
        closed[k] = x * x + z * z < reach[s] * reach[s]
    for k in range(len(wall_disk)):
        i = wall_disk[k]
        gap = wall_gap[k] + (wall_normal[k, 0] * q[i] + wall_normal[k, 1] * q[n + i])
        closed[len(first) + k] = gap < 0.0


@kernel
def count_closed(closed, first, second, wall_disk, count):
    """Fill ``count`` (n,): closed contacts of each disk, from what :func:`mark_closed` has marked."""
    count[:] = 0
    pairs = len(first)
    for k in range(pairs):
        if closed[k]:
            count[first[k]] += 1
            count[second[k]] += 1
    for k in range(len(wall_disk)):
        if closed[pairs + k]:
            count[wall_disk[k]] += 1
