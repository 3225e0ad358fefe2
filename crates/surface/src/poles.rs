//! Which poles are one: every face has a lattice of its own, and where two faces are one smooth surface they share poles.

use crate::lattice::Lattice;
use crate::layout::Layout;
use glam::{DVec2, DVec3};
use softfold_geometry::{ShellEdgeKind, UniformBicubic};
use std::collections::{BTreeMap, BTreeSet};

/// Places per cell at which a smooth edge is looked at for the cells that it crosses: it may miss one that it enters by less
/// than this share, where the surfaces part by its third power.
const PLACES_PER_CELL: f64 = 200.0;

/// The unknowns of a fit: the poles of all faces, those that faces share once.
#[derive(Clone, Debug)]
pub(crate) struct Poles {
    lattice: Lattice,
    faces: Vec<FacePoles>,
    /// How many unknowns there are.
    pub(crate) count: usize,
}

/// The part of the lattice that a face has, and the unknown at each of its poles (v inner).
#[derive(Clone, Debug)]
struct FacePoles {
    first: [usize; 2],
    count: [usize; 2],
    unknowns: Vec<u32>,
}

impl Poles {
    /// Numbers the poles of every face, which has a lattice over its box with `margin` cells around.
    pub(crate) fn new(lattice: Lattice, layout: &Layout, margin: u32) -> Self {
        let mut faces: Vec<FacePoles> = match layout.faces.len() {
            1 => vec![FacePoles::of([[0, lattice.count[0] - 1], [0, lattice.count[1] - 1]])],
            n => (0..n).map(|f| FacePoles::over(&lattice, layout.bounds(f), margin)).collect(),
        };
        let joined = joined(&lattice, layout);
        let mut count = 0;
        for pole in 0..lattice.vertices() {
            let here: Vec<usize> =
                (0..faces.len()).filter(|&f| faces[f].slot(&lattice, pole).is_some()).collect();
            let mut names: BTreeMap<usize, u32> = BTreeMap::new();
            for f in here {
                let name = *names.entry(leader(f, joined.get(&pole))).or_insert_with(|| {
                    count += 1;
                    count - 1
                });
                if let Some(slot) = faces[f].slot(&lattice, pole) {
                    faces[f].unknowns[slot] = name;
                }
            }
        }
        Self { lattice, faces, count: count as usize }
    }

    /// A row over the poles of the lattice as a row over the unknowns of a face.
    pub(crate) fn row(&self, face: usize, row: impl Iterator<Item = (u32, f64)>) -> Vec<(u32, f64)> {
        let of = &self.faces[face];
        row.filter_map(|(pole, w)| Some((of.unknowns[of.slot(&self.lattice, pole as usize)?], w))).collect()
    }

    /// How many faces there are.
    pub(crate) fn faces(&self) -> usize {
        self.faces.len()
    }

    /// Number of poles of a face.
    pub(crate) fn count_of(&self, face: usize) -> [usize; 2] {
        self.faces[face].count
    }

    /// The unknown at pole (i, j) of a face.
    pub(crate) fn unknown(&self, face: usize, i: usize, j: usize) -> u32 {
        let of = &self.faces[face];
        of.unknowns[i * of.count[1] + j]
    }

    /// Whether faces share poles.
    pub(crate) fn are_shared(&self) -> bool {
        self.faces.iter().map(|f| f.unknowns.len()).sum::<usize>() > self.count
    }

    /// The lattice of a face.
    pub(crate) fn lattice_of(&self, face: usize) -> Lattice {
        let FacePoles { first, count, .. } = self.faces[face];
        let h = self.lattice.spacing_mm;
        let origin = self.lattice.origin + h * DVec2::new(first[0] as f64, first[1] as f64);
        Lattice { origin, spacing_mm: h, count }
    }

    /// The surface of a face.
    pub(crate) fn spline(&self, face: usize, solution: &[DVec3]) -> UniformBicubic {
        let poles = self.faces[face].unknowns.iter().map(|&u| solution[u as usize]).collect();
        self.lattice_of(face).spline(poles)
    }
}

impl FacePoles {
    fn of(range: [[usize; 2]; 2]) -> Self {
        let count = range.map(|[from, to]| to - from + 1);
        Self { first: range.map(|r| r[0]), count, unknowns: vec![0; count[0] * count[1]] }
    }

    fn over(lattice: &Lattice, (lo, hi): (DVec2, DVec2), margin: u32) -> Self {
        let place = |p: DVec2| (p - lattice.origin) / lattice.spacing_mm;
        let (lo, hi, margin) = (place(lo).floor(), place(hi).ceil(), f64::from(margin));
        Self::of([0, 1].map(|d| {
            let last = (lattice.count[d] - 1) as f64;
            [(lo[d] - margin).clamp(0.0, last) as usize, (hi[d] + margin).clamp(0.0, last) as usize]
        }))
    }

    /// Where a pole of the whole lattice stands among those of the face.
    fn slot(&self, lattice: &Lattice, pole: usize) -> Option<usize> {
        let place = [pole / lattice.count[1], pole % lattice.count[1]];
        let [i, j] = [0, 1].map(|d| place[d].checked_sub(self.first[d]).filter(|k| *k < self.count[d]));
        Some(i? * self.count[1] + j?)
    }
}

/// Pairs of faces that are one surface around a pole.
type Pairs = BTreeMap<usize, BTreeSet<[usize; 2]>>;

/// Smooth edges make their faces share all poles that act in the cells they cross.
fn joined(lattice: &Lattice, layout: &Layout) -> Pairs {
    let mut pairs = Pairs::new();
    for (edge, sides) in layout.edges.iter().zip(&layout.sides) {
        let (ShellEdgeKind::Smooth, [Some(a), Some(b)]) = (edge.kind, *sides) else { continue };
        let steps = (edge.segment.length_mm() / lattice.spacing_mm * PLACES_PER_CELL).ceil().max(1.0);
        let cells: BTreeSet<[usize; 2]> =
            (0..=steps as usize).map(|k| lattice.cell(edge.segment.at(k as f64 / steps))).collect();
        for pole in cells.into_iter().flat_map(|cell| lattice.poles_of(cell)) {
            pairs.entry(pole).or_default().insert([a.min(b), a.max(b)]);
        }
    }
    pairs
}

/// The lowest of the faces that are one with a face.
fn leader(face: usize, pairs: Option<&BTreeSet<[usize; 2]>>) -> usize {
    let Some(pairs) = pairs else { return face };
    let mut group = BTreeSet::from([face]);
    loop {
        let more: Vec<usize> = pairs
            .iter()
            .filter(|p| p.iter().any(|f| group.contains(f)))
            .flatten()
            .copied()
            .filter(|f| !group.contains(f))
            .collect();
        if more.is_empty() {
            return group.first().copied().unwrap_or(face);
        }
        group.extend(more);
    }
}
