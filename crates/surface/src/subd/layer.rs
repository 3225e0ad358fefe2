//! Layers of quads along the border: they move the corners of the grid that the outline does not have into the sheet,
//! as inner vertices of valence 3.

use super::quads::Quads;
use glam::DVec2;
use std::f64::consts::PI;

/// A border vertex with one quad (or none straight on) whose inner angle the sheet has.
#[derive(Clone, Copy, PartialEq)]
enum Corner {
    /// The border goes straight on, or turns back: several quads meet.
    None,
    /// One quad, and the sheet has a corner.
    Hard,
    /// One quad, and the sheet goes on smoothly.
    Soft,
}

/// Adds `depth` layers along every stretch of border from hard corner to hard corner that has a soft one; `angle` is the
/// sheet's own inner angle at a border vertex.
pub(crate) fn add_layers(quads: &mut Quads, depth: u32, is_soft: &dyn Fn(DVec2) -> bool) {
    let Ok(sides) = quads.sides() else { return };
    for border in quads.borders(&sides) {
        for stretch in soft_stretches(quads, &border, is_soft) {
            stretch.add(quads, depth);
        }
    }
}

/// A row of border vertices.
struct Stretch {
    vertices: Vec<u32>,
    closed: bool,
}

fn soft_stretches(quads: &Quads, border: &[u32], is_soft: &dyn Fn(DVec2) -> bool) -> Vec<Stretch> {
    let mut count = vec![0; quads.points.len()];
    quads.quads.as_flattened().iter().for_each(|&v| count[v as usize] += 1);
    let corner = |v: u32| match count[v as usize] {
        1 if is_soft(quads.points[v as usize]) => Corner::Soft,
        1 => Corner::Hard,
        _ => Corner::None,
    };
    let corners: Vec<Corner> = border.iter().map(|&v| corner(v)).collect();
    let n = border.len();
    let hard: Vec<usize> = (0..n).filter(|&k| corners[k] == Corner::Hard).collect();
    if hard.is_empty() {
        let any = corners.contains(&Corner::Soft);
        return if any { vec![Stretch { vertices: border.to_vec(), closed: true }] } else { Vec::new() };
    }
    let stretch = |i: usize| {
        let (from, to) = (hard[i], hard[(i + 1) % hard.len()]);
        let length = if to > from { to - from } else { to + n - from };
        (0..=length).map(|k| (from + k) % n).collect::<Vec<_>>()
    };
    let soft = |s: &Vec<usize>| s[1..s.len() - 1].iter().any(|&k| corners[k] == Corner::Soft);
    let vertices = |s: Vec<usize>| s.into_iter().map(|k| border[k]).collect();
    (0..hard.len())
        .map(stretch)
        .filter(soft)
        .map(|s| Stretch { vertices: vertices(s), closed: false })
        .collect()
}

impl Stretch {
    /// The border keeps its places; what was there moves in by the layers' share of the cell behind it.
    ///
    /// At the ends the layers come out on the neighbouring stretches: there the old end slides along.
    fn add(&self, quads: &mut Quads, depth: u32) {
        let inward = self.inward(quads);
        let places: Vec<DVec2> = self.vertices.iter().map(|&v| quads.points[v as usize]).collect();
        // The ends' numbers stay with the outermost row, so that the neighbouring stretch still ends in its corner.
        let mut inner: Vec<u32> = self.vertices.clone();
        for (&v, by) in self.vertices.iter().zip(&inward) {
            quads.points[v as usize] += *by;
        }
        for level in (0..depth).rev() {
            let share = f64::from(level) / f64::from(depth);
            let outer: Vec<u32> = places
                .iter()
                .zip(&inward)
                .map(|(p, by)| {
                    quads.points.push(*p + share * *by);
                    quads.points.len() as u32 - 1
                })
                .collect();
            let n = inner.len();
            let last = if self.closed { n } else { n - 1 };
            for k in 0..last {
                let l = (k + 1) % n;
                quads.quads.push([outer[k], outer[l], inner[l], inner[k]]);
            }
            inner = outer;
        }
        self.swap_ends(quads, &inner);
    }

    /// Gives the old end's number to the new corner, and the new number to the old end.
    fn swap_ends(&self, quads: &mut Quads, outer: &[u32]) {
        if self.closed {
            return;
        }
        let last = self.vertices.len() - 1;
        for k in [0, last] {
            let (old, new) = (self.vertices[k], outer[k]);
            quads.points.swap(old as usize, new as usize);
            for v in quads.quads.iter_mut().flatten() {
                *v = if *v == old {
                    new
                } else if *v == new {
                    old
                } else {
                    *v
                };
            }
        }
    }

    /// Half of the mean edge that leads from each vertex into the sheet; at the ends along the neighbouring border.
    fn inward(&self, quads: &Quads) -> Vec<DVec2> {
        let around = quads.around();
        let own: std::collections::BTreeSet<u32> = self.vertices.iter().copied().collect();
        let of = |&v: &u32| {
            let edges = around[v as usize].iter().flat_map(|&(q, k)| {
                let quad = quads.quads[q];
                [quad[(k + 1) % 4], quad[(k + 3) % 4]]
            });
            let inner: Vec<DVec2> = edges
                .filter(|w| !own.contains(w))
                .map(|w| quads.points[w as usize] - quads.points[v as usize])
                .collect();
            let diagonal = |&(q, k): &(usize, usize)| {
                0.5 * (quads.points[quads.quads[q][(k + 2) % 4] as usize] - quads.points[v as usize])
            };
            match inner.is_empty() {
                true => 0.5 * around[v as usize].iter().map(diagonal).sum::<DVec2>(),
                false => 0.5 * inner.iter().copied().sum::<DVec2>() / inner.len() as f64,
            }
        };
        self.vertices.iter().map(of).collect()
    }
}

/// Whether a corner of the sheet is none to a quad: up to 135° it takes one quad, wider ones want an inner vertex of valence 3.
pub(crate) fn is_smooth(inner_angle_rad: f64) -> bool {
    inner_angle_rad > 0.75 * PI
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n × n squares.
    fn square(n: u32) -> Quads {
        let m = n + 1;
        let points = (0..m * m).map(|k| DVec2::new(f64::from(k / m), f64::from(k % m))).collect();
        let at = |i: u32, j: u32| i * m + j;
        let quad = |k: u32| {
            let (i, j) = (k / n, k % n);
            [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
        };
        Quads { points, quads: (0..n * n).map(quad).collect() }
    }

    fn inner_defects(quads: &Quads) -> usize {
        let sides = quads.sides().unwrap();
        let border: Vec<u32> = quads.borders(&sides).concat();
        let valences = quads.valences();
        (0..valences.len()).filter(|v| !border.contains(&(*v as u32)) && valences[*v] != 4).count()
    }

    #[test]
    fn a_ring_makes_inner_vertices_of_the_corners() {
        let mut quads = square(4);
        add_layers(&mut quads, 2, &|_| true);
        assert_eq!(quads.quads.len(), 16 + 2 * 16);
        assert_eq!(inner_defects(&quads), 4);
    }

    #[test]
    fn layers_between_hard_corners_come_out_on_the_sides() {
        let mut quads = square(4);
        add_layers(&mut quads, 1, &|p| p == DVec2::ZERO);
        let sides = quads.sides().unwrap();
        assert_eq!(quads.quads.len(), 16 + 8);
        assert_eq!(inner_defects(&quads), 1);
        assert_eq!(quads.borders(&sides).len(), 1);
        let corners: Vec<DVec2> = [(4., 0.), (0., 4.)].map(DVec2::from).to_vec();
        let valences = quads.valences();
        for c in corners {
            let v = quads.points.iter().position(|p| *p == c).unwrap();
            assert_eq!(valences[v], 2, "{c}");
        }
    }
}
