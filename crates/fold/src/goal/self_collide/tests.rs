//! The barrier by itself: distances, derivatives over all kinds of nearness, and steps that would tunnel.

use super::broad::Sheet;
use super::tree::Tree;
use super::way::{Path, Way};
use super::*;
use crate::goal::testing::{prove_by_steps, prove_convex, prove_descent, prove_rigid_invariance};
use crate::testing::{irregular, strip};
use softfold_geometry::{EdgeClass, LoopId, Site, SolveRecord, VertexId};

const OPTIONS: SelfCollideOptions = SelfCollideOptions { thickness_mm: 1.0, reach_mm: 0.5, stiffness: 3.0 };

/// Two triangles that are two sheets, side by side.
fn two_triangles() -> FlatMesh {
    let flat = [(0., 0.), (4., 0.), (0., 4.), (50., 0.), (54., 0.), (50., 4.)].map(DVec2::from).to_vec();
    let triangles = vec![[0, 1, 2].map(VertexId), [3, 4, 5].map(VertexId)];
    let boundary = EdgeClass::Boundary { loop_id: LoopId(0) };
    FlatMesh::new(flat, vec![Site::Interior; 6], triangles, |_, _| boundary)
}

fn goal() -> [Box<dyn Goal>; 1] {
    [Box::new(SelfCollide::of_mesh(&two_triangles(), OPTIONS))]
}

/// The first triangle lies flat; the second is given.
fn over(second: [(f64, f64, f64); 3]) -> Vec<DVec3> {
    let first = [(0., 0., 0.), (4., 0., 0.), (0., 4., 0.)];
    first.into_iter().chain(second).map(DVec3::from).collect()
}

/// Every kind of nearest places, all at 1.2 mm, with parallel edges, slivers and triangles without area.
fn shapes() -> Vec<(&'static str, Vec<DVec3>)> {
    vec![
        ("corner over face", over([(1.0, 1.1, 1.2), (2.0, 3.0, 6.0), (0.5, -2.0, 7.0)])),
        ("corner over edge", over([(2.0, -0.8, 0.9), (3.0, -4.0, 3.0), (0.4, -5.0, 2.0)])),
        ("corner over corner", over([(-0.7, -0.7, 0.7), (-3.0, -2.0, 4.0), (-2.0, -5.0, 1.0)])),
        ("edge over edge", over([(2.0, -3.0, 1.2), (1.7, 3.0, 1.25), (2.5, -2.0, 7.0)])),
        ("parallel edges", over([(0.5, -1.2, 0.1), (3.5, -1.2, 0.1), (2.0, -6.0, 2.0)])),
        ("nearly parallel edges", over([(0.5, -1.2, 0.1), (3.5, -1.22, 0.14), (2.0, -6.0, 2.0)])),
        ("crossing at a small angle", over([(0.5, -0.06, 1.2), (3.5, 0.06, 1.23), (2.0, -6.0, 8.0)])),
        ("face on face", over([(0.3, 0.4, 1.2), (2.1, 0.6, 1.25), (0.5, 2.2, 1.3)])),
        ("sliver", over([(1.0, 1.1, 1.2), (6.0, 1.102, 1.3), (11.0, 1.1, 1.4)])),
        ("no area", over([(1.0, 1.1, 1.2), (2.0, 1.2, 2.2), (3.0, 1.3, 3.2)])),
        ("deep", over([(1.0, 1.1, 1.002), (2.0, 3.0, 6.0), (0.5, -2.0, 7.0)])),
    ]
}

#[test]
fn derivatives_and_moves_are_those_of_the_energy() {
    for (name, x) in shapes() {
        let step = if name == "deep" { 1e-7 } else { 1e-6 };
        assert!(goal()[0].energy(&x) > 0.0, "{name} must touch");
        let run = std::panic::AssertUnwindSafe(|| prove_by_steps(&goal(), &x, step, 2e-5));
        assert!(std::panic::catch_unwind(run).is_ok(), "{name}");
    }
}

#[test]
fn the_convex_hessian_has_no_negative_direction() {
    shapes().iter().for_each(|(_, x)| prove_convex(&goal(), x));
}

#[test]
fn rigid_motions_change_nothing() {
    shapes().iter().for_each(|(_, x)| prove_rigid_invariance(&goal(), x));
}

#[test]
fn one_move_of_eq_4_does_not_raise_the_energy() {
    shapes().iter().for_each(|(_, x)| prove_descent(&goal(), x));
}

/// Steps without a pattern, each entry from −1 to 1.
fn noise(k: usize) -> f64 {
    2.0 * ((12.9898 * (k as f64 + 0.37)).sin() * 43758.5453).rem_euclid(1.0) - 1.0
}

fn shaken(count: usize, seed: usize, size: f64) -> Vec<DVec3> {
    let at = |i: usize, c: usize| noise(1009 * seed + 3 * i + c);
    (0..count).map(|i| size * DVec3::new(at(i, 0), at(i, 1), at(i, 2))).collect()
}

/// Least distance of two triangles by a search over points of both.
fn sampled_distance(x: &[DVec3]) -> f64 {
    const STEPS: u32 = 24;
    let points = |c: &[DVec3]| -> Vec<DVec3> {
        let share = |k: u32| f64::from(k) / f64::from(STEPS);
        let pairs = (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |j| (i, j)));
        pairs.map(|(i, j)| c[0] + share(i) * (c[1] - c[0]) + share(j) * (c[2] - c[0])).collect()
    };
    let (first, second) = (points(&x[..3]), points(&x[3..]));
    first.iter().flat_map(|p| second.iter().map(|q| p.distance(*q))).fold(f64::MAX, f64::min)
}

fn least_distance(x: &[DVec3]) -> f64 {
    let gap = Gap::new(1.0, 100.0);
    let found = Sheet::new(&two_triangles(), gap).candidates(x, &[], 0.0, true).unwrap();
    found.all().map(|p| p.distance_mm(x)).fold(f64::MAX, f64::min)
}

#[test]
fn distances_are_those_of_a_search_over_points() {
    for seed in 0..60 {
        let mut x = shaken(6, seed, 4.0);
        x[3..].iter_mut().for_each(|p| p.z += 9.0);
        let (found, sampled) = (least_distance(&x), sampled_distance(&x));
        assert!(found <= sampled + 1e-12 && sampled < found + 0.25, "{seed}: {found} {sampled}");
    }
}

#[test]
fn no_step_leads_through_and_free_steps_are_not_shortened() {
    let collide = SelfCollide::of_mesh(&two_triangles(), OPTIONS);
    let (mut limited, mut free) = (0, 0);
    for seed in 0..400 {
        let mut x = shaken(6, seed, 4.0);
        x[3..].iter_mut().for_each(|p| p.z += 10.0);
        let mut step = shaken(6, seed + 7000, 6.0);
        // The upper triangle falls, often through the lower one.
        step[3..].iter_mut().for_each(|d| d.z -= 3.0 + 30.0 * noise(seed + 90_000).abs());
        if least_distance(&x) <= 1.0 {
            continue;
        }
        let most = collide.largest_step(&x, &step);
        let at = |t: f64| -> Vec<DVec3> { x.iter().zip(&step).map(|(x, d)| *x + t * *d).collect() };
        let on_way = |k: u32, most: f64| least_distance(&at(most * f64::from(k) / 300.0));
        let nearest = (0..=300).map(|k| on_way(k, most)).fold(f64::MAX, f64::min);
        assert!(nearest > 1.0, "{seed}: {most} {nearest}");
        let nearest_of_all = (0..=300).map(|k| on_way(k, 1.0)).fold(f64::MAX, f64::min);
        if most < 1.0 {
            limited += 1;
            assert!(collide.energy(&at(most)).is_finite());
            // Nine tenths of the gap may be used, not much less.
            assert!(
                nearest_of_all < 1.0 + 0.2 * (least_distance(&x) - 1.0),
                "{seed}: {most} {nearest_of_all}"
            );
        } else {
            free += 1;
        }
    }
    assert!(limited > 60 && free > 60, "{limited} {free}");
}

#[test]
fn a_fall_straight_down_ends_where_nine_tenths_of_the_gap_are_used() {
    let x = over([(1.0, 1.0, 5.0), (2.0, 1.0, 5.0), (1.0, 2.0, 5.0)]);
    let mut step = vec![DVec3::ZERO; 6];
    step[3..].iter_mut().for_each(|d| d.z = -1000.0);
    let most = SelfCollide::of_mesh(&two_triangles(), OPTIONS).largest_step(&x, &step);
    // 4 mm of room.
    assert!(1000.0 * most >= 0.9 * 4.0 - 1e-9 && 1000.0 * most < 4.0, "{most}");
}

fn positions(mesh: &FlatMesh, f: impl Fn(DVec2) -> DVec3) -> Vec<DVec3> {
    mesh.vertices.iter().map(|p| f(*p)).collect()
}

/// A sheet of 1 mm meshed much finer and rolled to any radius feels nothing up to half a turn.
#[test]
fn bending_up_to_half_a_turn_meets_no_barrier_and_rolling_up_does() {
    let mesh = strip(40, 6, 0.3);
    let collide = SelfCollide::of_mesh(&mesh, OPTIONS);
    let rolled = |r: f64| positions(&mesh, |p| DVec3::new(r * (p.x / r).sin(), p.y, r - r * (p.x / r).cos()));
    for r in [1e6, 30.0, 12.0 / std::f64::consts::PI] {
        assert_eq!(collide.energy(&rolled(r)), 0.0, "radius {r}");
        assert!(collide.contacts(&rolled(r), 0.0).is_empty());
    }
    // Nearly a full turn: the ends come within 0.5 mm of each other.
    assert_eq!(collide.energy(&rolled(12.5 / std::f64::consts::TAU)), f64::INFINITY);
    assert!(collide.energy(&rolled(13.3 / std::f64::consts::TAU)).is_finite());
    assert!(collide.energy(&rolled(13.3 / std::f64::consts::TAU)) > 0.0);
}

/// Two layers of one strip, `gap` mm apart, by a fold in its middle.
fn doubled(mesh: &FlatMesh, gap: f64) -> Vec<DVec3> {
    let (middle, r) = (15.0, 0.5 * gap);
    positions(mesh, |p| {
        let off = p.x - middle;
        let half = 0.5 * std::f64::consts::PI * r;
        if off.abs() <= half {
            let a = off / r;
            DVec3::new(r * a.cos(), p.y, r * a.sin())
        } else {
            DVec3::new(half - off.abs(), p.y, r * off.signum())
        }
    })
}

#[test]
fn layers_push_each_other_from_the_contact_distance_on() {
    let mesh = strip(30, 4, 1.0);
    let collide = SelfCollide::of_mesh(&mesh, OPTIONS);
    assert_eq!(collide.energy(&doubled(&mesh, 1.6)), 0.0);
    let [far, near] = [1.4, 1.1].map(|gap| collide.energy(&doubled(&mesh, gap)));
    assert!(near > far && far > 0.0 && near.is_finite(), "{near} {far}");
    assert_eq!(collide.energy(&doubled(&mesh, 0.9)), f64::INFINITY);
    let clearance = |gap: f64| {
        let sheet =
            FoldedSheet { mesh: mesh.clone(), positions: doubled(&mesh, gap), solve: SolveRecord::default() };
        self_clearance(&sheet, 1.0, 2.0)
    };
    assert!(clearance(3.0).is_none());
    for gap in [1.5, 0.7] {
        let found = clearance(gap).unwrap();
        assert!((found.distance_mm - gap).abs() < 0.12 * gap, "{found:?}");
        // Opposite places of the two layers.
        assert!((found.at[0].x + found.at[1].x - 30.0).abs() < 2.5, "{found:?}");
    }
}

/// What was found before changes no result.
#[test]
fn a_used_goal_and_a_new_one_agree_to_the_bit() {
    let mesh = strip(30, 4, 1.0);
    let used = SelfCollide::of_mesh(&mesh, OPTIONS);
    for k in 0..40 {
        let gap = 1.05 + 0.02 * f64::from(k);
        let x = doubled(&mesh, gap);
        let new = SelfCollide::of_mesh(&mesh, OPTIONS);
        assert_eq!(used.energy(&x), new.energy(&x));
        assert_eq!(used.contacts(&x, 0.25), new.contacts(&x, 0.25));
        let step = shaken(x.len(), k as usize, 0.3);
        assert_eq!(used.largest_step(&x, &step), new.largest_step(&x, &step));
        let half: Vec<DVec3> = x.iter().zip(&step).map(|(x, d)| *x + 0.37 * *d).collect();
        assert_eq!(used.energy(&half), SelfCollide::of_mesh(&mesh, OPTIONS).energy(&half));
    }
}

/// All pairs, by looking at every two triangles, in the order of the search.
fn all_pairs(mesh: &FlatMesh) -> Vec<Pair> {
    let (sheet, n) = (Sheet::new(mesh, OPTIONS.gap()), mesh.triangles.len());
    let mut pairs = Vec::new();
    for a in 0..n {
        (a + 1..n).for_each(|b| sheet.pairs_between(a, b, |pair| pairs.push(pair)));
    }
    pairs
}

fn agrees_with_all_pairs(goal: &SelfCollide, pairs: &[Pair], x: &[DVec3]) -> bool {
    let energy = OPTIONS.stiffness * pairs.iter().map(|p| p.energy(x)).sum::<f64>();
    let touching = pairs.iter().filter(|p| p.distance_mm(x) < p.gap.within_mm(0.25));
    let mut coupled: Vec<[u32; 2]> = touching.flat_map(couples).collect();
    coupled.sort_unstable();
    coupled.dedup();
    assert_eq!(goal.energy(x).to_bits(), energy.to_bits());
    assert_eq!(goal.contacts(x, 0.25), coupled);
    energy > 0.0
}

/// Shapes of a sheet with a slit, much larger than its contact distance: wound to all radii, pleated, waved, rolled along slanted
/// lines, noisy, crumpled.
fn postures(mesh: &FlatMesh) -> Vec<Vec<DVec3>> {
    let roll = |r: f64, slant: f64| {
        positions(mesh, |p| {
            let (u, v) = (p.x + slant * p.y, p.y - slant * p.x);
            DVec3::new(r * (u / r).sin(), v, r - r * (u / r).cos())
        })
    };
    let pleat = |width: f64, rise: f64| {
        positions(mesh, |p| {
            let t = (p.x / width).rem_euclid(2.0);
            DVec3::new(0.12 * p.x, p.y, rise * if t < 1.0 { t } else { 2.0 - t })
        })
    };
    let flat = positions(mesh, |p| p.extend(0.0));
    let noisy = |size: f64, seed: usize| -> Vec<DVec3> {
        flat.iter().zip(shaken(flat.len(), seed, size)).map(|(x, d)| *x + d).collect()
    };
    let mut all: Vec<_> = [100.0, 12.0, 6.0, 3.8, 3.4, 2.9].map(|r| roll(r, 0.0)).to_vec();
    all.extend([30.0, 5.0, 2.5].map(|r| roll(r, 0.4)));
    all.extend([(9.0, 2.0), (9.0, 8.9), (5.0, 4.9), (7.0, 0.3)].map(|(w, h)| pleat(w, h)));
    all.extend([(0.1, 3), (0.4, 4), (1.5, 5), (6.0, 6)].map(|(size, seed)| noisy(size, seed)));
    all.push(flat.iter().map(|x| 0.5 * *x).collect());
    all.push(flat.iter().map(|x| DVec3::new(0.7 * x.x, x.y, 0.0)).collect());
    all.push(flat);
    all
}

/// A sheet cut open along a line, whose lips are two rows of vertices at the same places.
fn slit(mesh: &FlatMesh) -> FlatMesh {
    let (mut vertices, mut twin) = (mesh.vertices.clone(), std::collections::BTreeMap::new());
    let on = |p: DVec2| p.x == 12.0 && p.y > 3.0;
    let triangles = mesh.triangles.iter().map(|t| {
        let right = t.iter().map(|v| mesh.vertices[v.index()].x).sum::<f64>() > 36.0;
        t.map(|v| match right && on(mesh.vertices[v.index()]) {
            true => *twin.entry(v.0).or_insert_with(|| {
                vertices.push(mesh.vertices[v.index()]);
                VertexId::new(vertices.len() - 1)
            }),
            false => v,
        })
    });
    let triangles: Vec<_> = triangles.collect();
    let sites = vec![Site::Interior; vertices.len()];
    FlatMesh::new(vertices, sites, triangles, |_, boundary| match boundary {
        true => EdgeClass::Boundary { loop_id: LoopId(0) },
        false => EdgeClass::Facet,
    })
}

#[test]
fn the_search_finds_what_looking_at_all_pairs_finds() {
    for mesh in [strip(26, 9, 1.0), irregular(26, 9, 1.0, 5), slit(&strip(26, 9, 1.0)), strip(60, 3, 0.4)] {
        let (goal, pairs) = (SelfCollide::of_mesh(&mesh, OPTIONS), all_pairs(&mesh));
        let touching = postures(&mesh).iter().filter(|x| agrees_with_all_pairs(&goal, &pairs, x)).count();
        assert!(touching > 3 && touching + 3 < postures(&mesh).len(), "{touching}");
    }
}

#[test]
fn on_every_way_the_search_finds_what_looking_at_all_pairs_finds() {
    let mesh = slit(&strip(26, 5, 1.0));
    let (pairs, all) = (all_pairs(&mesh), postures(&mesh));
    let (mut free, mut limited) = (0, 0);
    for (k, from) in all.iter().enumerate().filter(|(_, x)| pairs.iter().all(|p| p.energy(x).is_finite())) {
        for to in all.iter().skip(k % 3).step_by(3) {
            let goal = SelfCollide::of_mesh(&mesh, OPTIONS);
            // The sheet swings as it bends.
            let turn = glam::DQuat::from_rotation_x(0.05 * k as f64);
            let step: Vec<DVec3> =
                from.iter().zip(to).map(|(x, to)| turn * *to + 40.0 * DVec3::Y - *x).collect();
            let most = goal.largest_step(from, &step);
            let at =
                |t: f64| -> Vec<DVec3> { from.iter().zip(&step).map(|(x, d)| *x + t * most * *d).collect() };
            for t in [0.3, 1.0] {
                agrees_with_all_pairs(&goal, &pairs, &at(t));
                assert!(goal.energy(&at(t)).is_finite(), "{k} {most} {t}");
            }
            if most < 1.0 { limited += 1 } else { free += 1 }
        }
    }
    assert!(limited > 10 && free > 10, "{limited} {free}");
}

/// Pairs of triangles whose bounds at time `t` of a way are within `reach` of each other, by looking at all.
fn near_at(corners: &[[u32; 3]], path: Path<'_>, t: f64, reach: f64) -> Vec<[u32; 2]> {
    let bounds = |c: &[u32; 3]| {
        let [p, q, r] = c.map(|v| path.x[v as usize] + t * path.step[v as usize]);
        (p.min(q).min(r), p.max(q).max(r))
    };
    let all: Vec<_> = corners.iter().map(bounds).collect();
    let near = |a: usize, b: usize| {
        (all[a].0 - all[b].1).max_element() < reach && (all[b].0 - all[a].1).max_element() < reach
    };
    let pairs = (0..all.len()).flat_map(|a| (a + 1..all.len()).map(move |b| (a, b)));
    pairs.filter(|(a, b)| near(*a, *b)).map(|(a, b)| [a as u32, b as u32]).collect()
}

/// On random ways, from hardly any motion to a tangle that crosses itself many times, all of them far off on the whole.
#[test]
fn the_tree_finds_all_triangles_that_come_near_each_other_on_random_ways() {
    let mesh = irregular(11, 7, 1.0, 11);
    let (n, corners) =
        (mesh.vertices.len(), mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect::<Vec<_>>());
    let tree = Tree::new(corners.clone(), &mesh.vertices);
    let mut counts = Vec::new();
    for seed in 0..24 {
        let shake = |size: f64, seed: usize| shaken(n, seed, size).into_iter();
        let x: Vec<DVec3> = positions(&mesh, |p| p.extend(0.0));
        let x: Vec<DVec3> =
            x.iter().zip(shake([0.1, 2.0, 8.0][seed % 3], seed)).map(|(x, d)| *x + d).collect();
        let drift = 1e3 * shaken(1, seed + 500, 1.0)[0];
        let step: Vec<DVec3> =
            shake([0.0, 0.3, 4.0, 30.0][seed % 4], seed + 900).map(|d| drift + d).collect();
        let (path, reach) = (Path { x: &x, step: &step }, [1e-3, 0.4, 2.0][seed / 8]);
        let found = tree.pairs(path, reach, |_| false, usize::MAX).unwrap();
        for k in 0..=16 {
            let near = near_at(&corners, path, f64::from(k) / 16.0, (1.0 - 1e-6) * reach);
            assert!(near.iter().all(|pair| found.binary_search(pair).is_ok()), "{seed} {k}");
        }
        // And no more than boxes that meet on their way.
        let ways: Vec<Way> = corners.iter().map(|c| path.around(c)).collect();
        let meet = |[a, b]: &[u32; 2]| ways[*a as usize].meets(&ways[*b as usize], reach);
        assert!(found.iter().all(meet) && found.is_sorted() && found.windows(2).all(|p| p[0] != p[1]));
        assert!(tree.pairs(path, reach, |_| false, found.len() - 1).is_none());
        assert_eq!(tree.pairs(path, reach, |_| false, found.len()), Some(found.clone()));
        counts.push(found.len());
    }
    let all = corners.len() * (corners.len() - 1) / 2;
    assert!(
        counts.iter().any(|c| *c < all / 10) && counts.iter().any(|c| *c > all / 2),
        "{counts:?} of {all}"
    );
}

/// Sheets of so few triangles that the tree has no branches.
#[test]
fn small_trees_find_their_pairs() {
    for triangles in [0_u32, 1, 2, 8, 9, 17] {
        let corners: Vec<[u32; 3]> = (0..triangles).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let flat: Vec<DVec2> =
            (0..3 * triangles).map(|v| DVec2::new(f64::from(v), f64::from(v % 3))).collect();
        let tree = Tree::new(corners.clone(), &flat);
        let (x, step) = (shaken(flat.len(), 3, 1.0), vec![DVec3::ZERO; flat.len()]);
        let path = Path { x: &x, step: &step };
        assert_eq!(tree.pairs(path, 0.3, |_| false, usize::MAX), Some(near_at(&corners, path, 0.0, 0.3)));
    }
}

/// What makes it fast: of a gently bent sheet that swings about, no pair at all is looked at closely.
#[test]
fn where_the_sheet_bends_little_nothing_is_looked_at() {
    let mesh = strip(60, 40, 0.5);
    let sheet = Sheet::new(&mesh, OPTIONS.gap());
    let roll = |r: f64| positions(&mesh, |p| DVec3::new(r * (p.x / r).sin(), p.y, r - r * (p.x / r).cos()));
    let turn = glam::DQuat::from_rotation_y(0.4);
    let step: Vec<DVec3> = roll(60.0).iter().zip(roll(50.0)).map(|(x, to)| turn * to - *x).collect();
    assert_eq!(sheet.candidates(&roll(60.0), &step, 0.25, true).unwrap().all().count(), 0);
    // Nor where it bends by a quarter of a turn within a few of the contact distances.
    let step: Vec<DVec3> = roll(8.0).iter().zip(roll(7.5)).map(|(x, to)| turn * to - *x).collect();
    assert_eq!(sheet.candidates(&roll(8.0), &step, 0.25, true).unwrap().all().count(), 0);
    // Nearly a full turn does touch.
    assert!(sheet.candidates(&roll(4.95), &[], 0.25, true).unwrap().all().count() > 0);
}

#[test]
fn positions_that_are_no_numbers_give_no_number() {
    let mesh = two_triangles();
    let collide = SelfCollide::of_mesh(&mesh, OPTIONS);
    assert!(collide.energy(&[DVec3::NAN; 6]).is_nan());
    assert_eq!(collide.largest_step(&[DVec3::ZERO; 6], &[DVec3::NAN; 6]), 1.0);
}
