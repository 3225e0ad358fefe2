"""What ezdxf and shapely say of DXF files: one JSON object, file by file, on standard output.

    python dxf.py FILE.dxf...

Facts only; the caller judges. A file that cannot be read gets the key "error".
Curves are flattened to CHORD_MM; two pieces of line are the same when their ends agree to GRID_MM.
"""

import itertools
import json
import sys
from collections import Counter

import ezdxf
from ezdxf import path as ezpath
from shapely import Polygon, STRtree

CHORD_MM = 0.01
GRID_MM = 1e-3
AREA_MM2 = 1e-2  # contours that overlap by less than this touch
TEXTS = {"TEXT", "MTEXT"}


def text_of(entity):
    return entity.plain_text() if entity.dxftype() in TEXTS else None


def contours_of(entity):
    """The entity as chains of points, and whether each is closed."""
    for part in ezpath.make_path(entity).sub_paths():
        points = [(p.x, p.y) for p in part.flattening(CHORD_MM)]
        closed = len(points) > 2 and max(abs(a - b) for a, b in zip(points[0], points[-1])) <= GRID_MM
        yield points, closed


def snapped(point):
    return tuple(round(x / GRID_MM) for x in point)


def segments(points):
    for a, b in itertools.pairwise(map(snapped, points)):
        if a != b:
            yield (min(a, b), max(a, b))


def crossing_pairs(polygons):
    """Pairs of closed contours that overlap without one holding the other: parts nested onto each other."""
    tree, pairs = STRtree(polygons), []
    for i, a in enumerate(polygons):
        for j in (int(j) for j in tree.query(a) if j > i):
            b = polygons[j]
            shared = a.intersection(b).area
            if AREA_MM2 < shared < min(a.area, b.area) - AREA_MM2:
                pairs.append({"contours": [i, j], "shared_mm2": shared})
    return pairs


def facts_of_layer(entities):
    chains, other, texts = [], Counter(), []
    for entity in entities:
        text = text_of(entity)
        if text is not None:
            texts.append(text)
            continue
        try:
            chains.extend(contours_of(entity))
        except TypeError:
            other[entity.dxftype()] += 1
    polygons = [Polygon(points) for points, closed in chains if closed]
    points = [p for chain, _ in chains for p in chain]
    return {
        "entities": len(entities),
        "kinds": dict(Counter(e.dxftype() for e in entities)),
        "closed": len(polygons),
        "open": sum(not closed for _, closed in chains),
        "self_crossing": sum(not p.is_valid for p in polygons),
        "crossing": crossing_pairs([p for p in polygons if p.is_valid]),
        "texts": texts,
        "without_geometry": dict(other),
        "length_mm": sum(((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
                         for chain, _ in chains for (x0, y0), (x1, y1) in itertools.pairwise(chain)),
        "box_mm": [min(p[0] for p in points), min(p[1] for p in points),
                   max(p[0] for p in points), max(p[1] for p in points)] if points else None,
    }, [s for chain, _ in chains for s in segments(chain)]


def facts_of_document(path):
    document = ezdxf.readfile(path)
    audit = document.audit()
    by_layer = {}
    for entity in document.modelspace():
        by_layer.setdefault(entity.dxf.layer, []).append(entity)
    layers, drawn = {}, Counter()
    for name in sorted(by_layer):
        layers[name], lines = facts_of_layer(by_layer[name])
        drawn.update(lines)
    twice = [[[x * GRID_MM for x in end] for end in line] for line, count in drawn.items() if count > 1]
    return {
        "version": document.dxfversion,
        "insunits": document.header.get("$INSUNITS", 0),
        "errors": [e.message for e in audit.errors],
        "fixes": [e.message for e in audit.fixes],
        "declared_layers": sorted(layer.dxf.name for layer in document.layers),
        "layers": layers,
        "twice": len(twice),
        "twice_first": twice[:5],
    }


def facts(path):
    try:
        return facts_of_document(path)
    except Exception as fault:  # whatever a reader throws is a fact about the file
        return {"error": f"{type(fault).__name__}: {fault}"}


if __name__ == "__main__":
    json.dump({path: facts(path) for path in sys.argv[1:]}, sys.stdout, indent=1)
