"""A mesh of 6-node triangles of a probed phantom, for probe_force.py: blocks of a butterfly around the disc.

Lengths in m; x lateral, y up, the undeformed surface at y = 0. The middle is the disc (a rectangle bent into it and
four sectors); around it, four sectors run to the sides of a box as high as the gel; left and right of the box are plain
rectangles, on top of all lies the skin.
"""

import numpy as np
from skfem import MeshTri1, MeshTri2

WIDTH, GEL, SKIN = 0.034, 0.015, 0.0005
RADIUS, BOX = 0.0032, 0.005
GEL_REGION, SKIN_REGION, DISC_REGION = 0, 1, 2


class Blocks:
    """Nodes and triangles of blocks that share their borders: nodes at the same place are one."""

    def __init__(self):
        self.number, self.points, self.triangles, self.regions, self.circle = {}, [], [], [], set()

    def node(self, point, on_circle=False):
        key = (round(point[0] * 1e10), round(point[1] * 1e10))
        if key not in self.number:
            self.number[key] = len(self.points)
            self.points.append(point)
        if on_circle:
            self.circle.add(self.number[key])
        return self.number[key]

    def add(self, grid, region, circle_row=None):
        """A block of (rows + 1) × (columns + 1) points. Each quadrilateral becomes two triangles, those on the right the
        mirror image of those on the left."""
        rows, columns = grid.shape[0] - 1, grid.shape[1] - 1
        n = [[self.node(tuple(grid[i, j]), i == circle_row) for j in range(columns + 1)] for i in range(rows + 1)]
        for i in range(rows):
            for j in range(columns):
                quad = [n[i][j], n[i][j + 1], n[i + 1][j + 1], n[i + 1][j]]
                corners = np.array([self.points[k] for k in quad])
                # The shorter diagonal; the middle of equals by the side of the axis, for the mirror image.
                first, second = (np.linalg.norm(corners[a] - corners[b]) for a, b in ((0, 2), (1, 3)))
                right = corners[:, 0].mean() > 0
                rising = (corners[2] - corners[0])[0] * (corners[2] - corners[0])[1] > 0
                use_first = first < second if abs(first - second) > 1e-9 else rising == right
                split = ((0, 1, 2), (0, 2, 3)) if use_first else ((0, 1, 3), (1, 2, 3))
                for abc in split:
                    t = [quad[k] for k in abc]
                    p, q, r = (np.array(self.points[k]) for k in t)
                    if (q - p)[0] * (r - p)[1] - (q - p)[1] * (r - p)[0] < 0:
                        t[1], t[2] = t[2], t[1]
                    self.triangles.append(t)
                    self.regions.append(region)


def graded(count, end):
    """Fractions 0 … 1 with the cell at 0 about `end` of the mean: x(s) = s (end + (1 − end) s)."""
    s = np.linspace(0, 1, count + 1)
    return s * (end + (1 - end) * s)


def between(a, b, fractions):
    """Points from the curve a to the curve b, (fractions, points, 2)."""
    return a[None] + fractions[:, None, None] * (b - a)[None]


def build(depth, size):
    """The mesh for a disc whose top is `depth` below the surface, with cells of `size` along the surface: 1 mm over a
    whole number gives whole numbers of cells everywhere. Returns the mesh and the region of each triangle."""
    centre = np.array([0.0, -(depth + RADIUS)])
    top, floor, wall = -SKIN, -(GEL + SKIN), WIDTH / 2
    across = 2 * round(BOX / size)
    outside = round((wall - BOX) / size)
    down = round(GEL / (1.5 * size))
    radial, rings = round(0.003 / size), round(0.002 / size)
    rows_of_skin = round(0.001 / size)
    heights = top - (top - floor) * graded(down, 0.6)
    widths = np.linspace(-BOX, BOX, across + 1)

    blocks = Blocks()
    box = {
        "top": np.array([[x, top] for x in widths]),
        "bottom": np.array([[x, floor] for x in widths]),
        "left": np.array([[-BOX, y] for y in heights]),
        "right": np.array([[BOX, y] for y in heights]),
    }
    rim, inner = {}, {}
    for side, points in box.items():
        rays = points - centre
        rim[side] = centre + RADIUS * rays / np.linalg.norm(rays, axis=1)[:, None]
    # The inner rectangle: half as far out as the rim at the corners, and bent half way towards it between them.
    for side in box:
        chord = rim[side][0] + (rim[side][-1] - rim[side][0]) * np.linspace(0, 1, len(rim[side]))[:, None]
        inner[side] = centre + 0.55 * (0.5 * chord + 0.5 * rim[side] - centre)
    for side in box:
        blocks.add(between(rim[side], box[side], np.linspace(0, 1, radial + 1)), GEL_REGION, circle_row=0)
        blocks.add(between(inner[side], rim[side], np.linspace(0, 1, rings + 1)), DISC_REGION, circle_row=rings)
    blocks.add(transfinite(inner), DISC_REGION)
    beyond = BOX + (wall - BOX) * np.linspace(0, 1, outside + 1)
    for sign in (-1, 1):
        blocks.add(np.array([[[sign * x, y] for x in beyond] for y in heights]), GEL_REGION)
    columns = np.concatenate([-beyond[:0:-1], widths, beyond[1:]])
    blocks.add(np.array([[[x, y] for x in columns] for y in np.linspace(top, 0, rows_of_skin + 1)]), SKIN_REGION)
    return curved(blocks, centre), np.array(blocks.regions)


def transfinite(sides):
    """The inside of four curves (Coons)."""
    up, low, left, right = (sides[s] for s in ("top", "bottom", "left", "right"))
    s = np.linspace(0, 1, len(left))[:, None, None]
    t = np.linspace(0, 1, len(up))[None, :, None]
    along = (1 - s) * up[None] + s * low[None] + (1 - t) * left[:, None] + t * right[:, None]
    return along - ((1 - s) * (1 - t) * up[0] + (1 - s) * t * up[-1] + s * (1 - t) * low[0] + s * t * low[-1])


def curved(blocks, centre):
    """The mesh with its middles of sides; those between two nodes of the rim lie on the circle."""
    straight = MeshTri1(np.array(blocks.points).T.copy(), np.array(blocks.triangles).T.copy(), sort_t=False)
    first, second = straight.facets
    middles = (straight.p[:, first] + straight.p[:, second]) / 2
    on_rim = np.array([a in blocks.circle and b in blocks.circle for a, b in straight.facets.T])
    arms = middles[:, on_rim] - centre[:, None]
    middles[:, on_rim] = centre[:, None] + RADIUS * arms / np.linalg.norm(arms, axis=0)
    return MeshTri2(np.hstack([straight.p, middles]), straight.t, sort_t=False)
