use super::*;
use glam::DVec2;

fn curve(points: &[(f64, f64)]) -> PlanarCurve {
    PlanarCurve::polyline(&points.iter().map(|&p| DVec2::from(p)).collect::<Vec<_>>()).unwrap()
}

fn square(lo: f64, hi: f64) -> PlanarCurve {
    curve(&[(lo, lo), (hi, lo), (hi, hi), (lo, hi), (lo, lo)])
}

fn crease(points: &[(f64, f64)]) -> Cut {
    Cut { curve: curve(points), kind: CutKind::Crease { crease: CreaseId(0), line: 0 } }
}

fn slit(points: &[(f64, f64)]) -> Cut {
    Cut { curve: curve(points), kind: CutKind::Slit }
}

/// Area of each face, and the sum of the areas must be that of the trim.
fn areas(layout: &Layout, trim: &[PlanarCurve]) -> Vec<f64> {
    let of_loop = |l: &Vec<DVec2>| polygon::signed_area_mm2(l);
    let all: Vec<f64> = layout.outlines.iter().map(|o| o.loops.iter().map(of_loop).sum()).collect();
    let whole: f64 = trim.iter().map(PlanarCurve::signed_area_mm2).sum();
    assert!((all.iter().sum::<f64>() - whole).abs() < 1e-3, "{all:?}");
    all
}

fn sides_are_right(layout: &Layout) {
    for (edge, sides) in layout.edges.iter().zip(&layout.sides) {
        let middle = edge.segment.at(0.5);
        let across = (edge.segment.at(0.51) - middle).perp().normalize() * 0.01;
        assert_eq!(Some(layout.face_of(middle + across)), sides[0], "{edge:?}");
        if let Some(right) = sides[1] {
            assert_eq!(layout.face_of(middle - across), right, "{edge:?}");
        }
    }
}

fn count(layout: &Layout, kind: ShellEdgeKind) -> usize {
    layout.edges.iter().filter(|e| e.kind == kind).count()
}

#[test]
fn without_cuts_there_is_one_face_with_its_holes() {
    let trim = [square(0.0, 100.0), square(30.0, 60.0).reversed()];
    let layout = Layout::new(&trim, &[]).unwrap();
    assert_eq!(areas(&layout, &trim), [10_000.0 - 900.0]);
    assert_eq!((layout.faces[0].len(), layout.edges.len(), layout.corners), (2, 8, 8));
    sides_are_right(&layout);
}

#[test]
fn a_crease_from_side_to_side_makes_two_faces_that_share_it() {
    let trim = [square(0.0, 100.0)];
    let layout = Layout::new(&trim, &[crease(&[(40.0, 0.0), (45.0, 50.0), (40.0, 100.0)])]).unwrap();
    assert_eq!(areas(&layout, &trim).len(), 2);
    assert_eq!((count(&layout, ShellEdgeKind::Crease), count(&layout, ShellEdgeKind::Border)), (2, 6));
    assert_eq!(layout.corners, 7);
    assert!(layout.lost.is_empty());
    sides_are_right(&layout);
}

#[test]
fn creases_that_meet_in_a_point_share_one_corner() {
    let trim = [square(0.0, 100.0)];
    let to = [(0.0, 40.0), (60.0, 0.0), (100.0, 70.0), (30.0, 100.0)];
    let cuts: Vec<_> = to.iter().map(|&p| crease(&[(50.0, 50.0), p])).collect();
    let layout = Layout::new(&trim, &cuts).unwrap();
    assert_eq!(areas(&layout, &trim).len(), 4);
    assert_eq!(layout.corners, 4 + 4 + 1);
    sides_are_right(&layout);
}

#[test]
fn a_closed_crease_leaves_a_face_within_a_face() {
    let trim = [square(0.0, 100.0), square(45.0, 55.0).reversed()];
    let ring = crease(&[(20.0, 20.0), (80.0, 20.0), (80.0, 80.0), (20.0, 80.0), (20.0, 20.0)]);
    let layout = Layout::new(&trim, &[ring]).unwrap();
    let mut found = areas(&layout, &trim);
    found.sort_by(f64::total_cmp);
    assert_eq!(found, [3_500.0, 6_400.0]);
    assert!(layout.faces.iter().all(|f| f.len() == 2));
    sides_are_right(&layout);
}

#[test]
fn what_ends_inside_goes_on_smoothly_to_the_next_curve() {
    let trim = [square(0.0, 100.0)];
    let cuts = [crease(&[(0.0, 50.0), (40.0, 50.0)]), crease(&[(70.0, 0.0), (70.0, 100.0)])];
    let layout = Layout::new(&trim, &cuts).unwrap();
    assert_eq!(areas(&layout, &trim).len(), 3);
    assert_eq!(count(&layout, ShellEdgeKind::Smooth), 1);
    let smooth = layout.edges.iter().find(|e| e.kind == ShellEdgeKind::Smooth).unwrap();
    assert_eq!(smooth.segment, Segment::Line { from: DVec2::new(40.0, 50.0), to: DVec2::new(70.0, 50.0) });
    sides_are_right(&layout);
}

#[test]
fn the_lips_of_a_slit_are_edges_of_their_own() {
    let trim = [square(0.0, 100.0)];
    let layout = Layout::new(&trim, &[slit(&[(0.0, 50.0), (60.0, 50.0)])]).unwrap();
    assert_eq!(areas(&layout, &trim).len(), 2);
    assert_eq!((count(&layout, ShellEdgeKind::Slit), count(&layout, ShellEdgeKind::Smooth)), (2, 1));
    let lips: Vec<_> = layout.edges.iter().filter(|e| e.kind == ShellEdgeKind::Slit).collect();
    // One tip, two corners at the mouth.
    assert_eq!(lips[0].corners[1], lips[1].corners[0]);
    assert_ne!(lips[0].corners[0], lips[1].corners[1]);
    assert_eq!(layout.corners, 4 + 2 + 1 + 1);
    sides_are_right(&layout);
}

#[test]
fn a_crease_that_divides_nothing_is_told() {
    let trim = [square(0.0, 100.0), square(40.0, 60.0).reversed()];
    let layout = Layout::new(&trim, &[crease(&[(0.0, 50.0), (40.0, 50.0)])]).unwrap();
    assert_eq!(layout.lost, [0]);
    assert_eq!(areas(&layout, &trim).len(), 1);
    assert_eq!(count(&layout, ShellEdgeKind::Crease), 0);
}
