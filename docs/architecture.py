#!/usr/bin/env python3
"""Draws docs/architecture.svg from the swingbank_module lines of the CMakeLists.txt files.

  python3 docs/architecture.py [--check]    --check changes nothing and exits with 1 if the drawing is out of date

Each module is one layer above the highest module that it uses. Arrows that follow from other arrows are omitted.
The modules of a layer are ordered by the barycentre method of Sugiyama, Tagawa and Toda, IEEE Trans. SMC 11 (1981) 109.
"""
import functools
import graphlib
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COLOURS = {"base": "#e8e8e8", "sim": "#dbe9f6", "mpi": "#fdebd0", "train": "#e3f1dc", "validate": "#f3e1f0", "research": "#fdf6d8", "jobs": "#fff"}
WIDTH, BOX, STEP, GAP, MARGIN = 900, 26, 66, 14, 16  # px; a layer is STEP high


def read_modules():
    """Returns for each module the modules that its headers or sources use."""
    modules = {}
    for folder in ("base", "sim", "mpi", "train", "validate", "research"):
        text = re.sub(r"#.*", "", (ROOT / folder / "CMakeLists.txt").read_text())
        for words in re.findall(r"^swingbank_module\(([^)]*)\)", text, re.M):
            module, *rest = words.split()
            key, modules[module] = "", []
            for word in rest:
                if word in ("USES", "INSIDE", "LINK", "SOURCES", "KIND"):
                    key = word
                elif key in ("USES", "INSIDE"):
                    modules[module].append(word)
    for module, used in modules.items():
        for other in used:
            if other not in modules:
                sys.exit(f"no module {other} at the swingbank_module line of {module} (no CMakeLists.txt defines it): correct the name")
    try:
        graphlib.TopologicalSorter(modules).prepare()
    except graphlib.CycleError as circle:
        sys.exit(f"a dependency cycle at the swingbank_module lines of {', '.join(circle.args[1][1:])} (dependencies must be "
                 "acyclic): move the common part into a lower module")
    return modules


def layers_of(modules):
    """Returns the layers from the bottom, with a node where an arrow crosses a layer, and each arrow as a list of nodes."""
    @functools.cache
    def rank(module):
        return 1 + max(map(rank, modules[module]), default=-1)

    @functools.cache
    def reached(module):
        return frozenset(modules[module]).union(*map(reached, modules[module]))

    layers = [[] for _ in range(1 + max(map(rank, modules)))]
    for module in modules:
        layers[rank(module)].append(module)
    arrows = []
    for module, used in modules.items():
        for other in used:
            if any(other in reached(third) for third in used if third != other):
                continue
            marks = [(module, other, k) for k in range(rank(module) - 1, rank(other), -1)]
            for mark in marks:
                layers[mark[2]].append(mark)
            arrows.append([module, *marks, other])
    return layers, arrows


def crossings(layers, below):
    count = 0
    for upper, lower in zip(layers[1:], layers):
        at = {node: i for i, node in enumerate(lower)}
        ends = [(i, at[other]) for i, node in enumerate(upper) for other in below[node]]
        count += sum(a < c and b > d for a, b in ends for c, d in ends)
    return count


def order(layers, arrows):
    """Orders each layer for few crossings: sorts nodes by the mean of their neighbours, upwards and downwards in turn."""
    below = {node: [] for layer in layers for node in layer}
    above = {node: [] for node in below}
    for arrow in arrows:
        for upper, lower in zip(arrow, arrow[1:]):
            below[upper].append(lower)
            above[lower].append(upper)
    best = [list(layer) for layer in layers]
    fewest = crossings(best, below)
    for sweep in range(60):
        neighbours, way = (below, range(1, len(layers))) if sweep % 2 == 0 else (above, range(len(layers) - 2, -1, -1))
        for k in way:
            beside = layers[k - 1] if sweep % 2 == 0 else layers[k + 1]
            at = {node: (i + 0.5) / len(beside) for i, node in enumerate(beside)}
            own = {node: (i + 0.5) / len(layers[k]) for i, node in enumerate(layers[k])}
            layers[k].sort(key=lambda node: (sum(at[n] for n in neighbours[node]) / len(neighbours[node])
                                             if neighbours[node] else own[node]))
        count = crossings(layers, below)
        if count < fewest:
            fewest, best = count, [list(layer) for layer in layers]
    return best, {node: below[node] + above[node] for node in below}


def width(node):
    return 7 * len(node) + 16 if isinstance(node, str) else 4


def place(layer, wanted):
    """Returns positions without overlap, nearest to the wanted positions in least squares (pooling of adjacent nodes)."""
    offsets, offset = [], 0.0
    for i, node in enumerate(layer):
        offset += (width(layer[i - 1]) + width(node)) / 2 + GAP if i else 0.0
        offsets.append(offset)
    pools = []
    for node, shift in zip(layer, offsets):
        pools.append([wanted[node] - shift, 1])
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            mean, count = pools.pop()
            pools[-1] = [(pools[-1][0] * pools[-1][1] + mean * count) / (pools[-1][1] + count), pools[-1][1] + count]
    starts = [mean for mean, count in pools for _ in range(count)]
    low = MARGIN + width(layer[0]) / 2
    high = WIDTH - MARGIN - width(layer[-1]) / 2 - offsets[-1]
    return {node: min(max(start, low), high) + shift for node, start, shift in zip(layer, starts, offsets)}


def positions(layers, neighbours):
    x = {node: WIDTH * (i + 0.5) / len(layer) for layer in layers for i, node in enumerate(layer)}
    for sweep in range(40):
        for layer in layers if sweep % 2 else reversed(layers):
            near = {n: [x[o] for o in neighbours[n]] or [x[n]] for n in layer}
            x.update(place(layer, {n: sum(near[n]) / len(near[n]) for n in layer}))
    return x


def drawing(modules):
    layers, arrows = layers_of(modules)
    layers, neighbours = order(layers, arrows)
    x = positions(layers, neighbours)
    top = 112
    y = {node: top + STEP * (len(layers) - 1 - k) for k, layer in enumerate(layers) for node in layer}
    height = top + STEP * (len(layers) - 1) + BOX + MARGIN
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" '
           'font-size="12" fill="#222">',
           "<title>The modules of Swingbank: an arrow leads from a module to one that it uses</title>",
           f'<rect width="{WIDTH}" height="{height}" fill="#fff"/>',
           '<defs><marker id="a" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
           '<path d="M0 0L8 4L0 8z" fill="#666"/></marker></defs>']
    out.append(f'<text x="{MARGIN}" y="24">An arrow leads from a module to one that it uses. Arrows that follow from other '
               "arrows are omitted.</text>")
    out.append(f'<rect x="{MARGIN}" y="44" width="{WIDTH - 2 * MARGIN}" height="{BOX}" rx="4" fill="{COLOURS["jobs"]}" '
               'stroke="#888"/>')
    out.append(f'<text x="{WIDTH / 2:g}" y="61" text-anchor="middle">jobs: one command a file; each names the modules it '
               "uses</text>")
    for arrow in arrows:
        path = f"M{x[arrow[0]]:.1f} {y[arrow[0]] + BOX}"
        for upper, lower in zip(arrow, arrow[1:]):
            start, end = y[upper] + BOX, y[lower]
            middle = (start + end) / 2
            path += f"C{x[upper]:.1f} {middle:g} {x[lower]:.1f} {middle:g} {x[lower]:.1f} {end}"
            if lower != arrow[-1]:
                path += f"V{end + BOX}"
        out.append(f'<path d="{path}" fill="none" stroke="#999" marker-end="url(#a)"/>')
    for module in modules:
        w = width(module)
        colour = COLOURS[module.split("/")[0]]
        out.append(f'<rect x="{x[module] - w / 2:.1f}" y="{y[module]}" width="{w}" height="{BOX}" rx="4" fill="{colour}" '
                   'stroke="#888"/>')
        out.append(f'<text x="{x[module]:.1f}" y="{y[module] + 17}" text-anchor="middle">{module}</text>')
    return "\n".join(out) + "\n</svg>\n"


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(f"unknown option at '{sys.argv[1]}' (docs/architecture.py accepts --check only): remove it")
    file = ROOT / "docs" / "architecture.svg"
    text = drawing(read_modules())
    if not sys.argv[1:]:
        file.write_text(text)
    elif not file.exists() or file.read_text() != text:
        sys.exit("out of date at docs/architecture.svg (the CMakeLists.txt files name other modules): "
                 "run python3 docs/architecture.py")


main()
