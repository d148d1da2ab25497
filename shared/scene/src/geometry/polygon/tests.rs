use super::*;

const DX: f64 = 0.01;

fn polygon(outline: &[[f64; 2]], holes: &[&[[f64; 2]]]) -> Polygon {
    Polygon::new(outline.to_vec(), holes.iter().map(|hole| hole.to_vec()).collect()).expect("a region")
}

fn fault(outline: &[[f64; 2]], holes: &[&[[f64; 2]]]) -> String {
    let holes = holes.iter().map(|hole| hole.to_vec()).collect();
    Polygon::new(outline.to_vec(), holes).expect_err("no region").reason
}

fn spacing(wall: bool, nodal: bool) -> Spacing {
    Spacing { dx: DX, nodal, wall, aligned: !wall, support: 3.0, turn: 0.0 }
}

fn rectangle(low: [f64; 2], high: [f64; 2]) -> [[f64; 2]; 4] {
    [low, [high[0], low[1]], high, [low[0], high[1]]]
}

/// In whole hundredths of a spacing, sorted: with normal and corner.
fn rounded(points: &[Point<2>]) -> Vec<([i64; 2], [i64; 2], bool)> {
    let mut all: Vec<_> = points
        .iter()
        .map(|p| {
            let (x, n) =
                (p.position.map(|x| (x / DX * 100.0).round()), p.normal.map(|n| (n * 1000.0).round()));
            (x.map(|x| x as i64), n.map(|n| n as i64), p.corner)
        })
        .collect();
    all.sort_unstable();
    all
}

#[test]
fn a_rectangle_is_filled_as_a_box_is() {
    let corners = rectangle([0.02, 0.01], [0.12, 0.05]);
    let block = crate::Block { min: [0.02, 0.01, 0.0], max: [0.12, 0.05, 0.0] };
    for nodal in [false, true] {
        let filled = polygon(&corners, &[]).fill::<2>(spacing(false, nodal), true);
        let in_box =
            crate::geometry::points::of_shape::<2>(&crate::Geometry::Box(block), spacing(false, nodal));
        let places = |points: &[Point<2>]| rounded(points).into_iter().map(|p| p.0).collect::<Vec<_>>();
        assert_eq!(places(&filled), places(&in_box));
        assert_eq!(filled.len(), if nodal { 9 * 3 } else { 10 * 4 });
    }
}

#[test]
fn the_lattice_of_a_solid_lies_along_its_longest_side() {
    // A bar of 20 by 4 spacings, at 30 degrees.
    let (sin, cos) = (0.5, 0.75_f64.sqrt());
    let turned = rectangle([0.0, 0.0], [0.2, 0.04]).map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]);
    let points = polygon(&turned, &[]).fill::<2>(spacing(false, false), true);
    assert_eq!(points.len(), 20 * 4);
    let back = points.iter().map(|p| p.position).map(|[x, y]| [cos * x + sin * y, cos * y - sin * x]);
    let off = |x: f64| (x / DX - 0.5).rem_euclid(1.0).min(1.0 - (x / DX - 0.5).rem_euclid(1.0));
    assert!(back.flatten().all(|x| off(x) < 1e-9), "every particle in the middle of a cell along the bar");
}

#[test]
fn rows_around_a_cavity_are_those_of_a_tank() {
    let cavity = crate::Block { min: [0.0; 3], max: [0.1, 0.06, 0.0] };
    let tank = crate::Geometry::Tank { cavity, open: Vec::new() };
    let around = rectangle([-1.0, -1.0], [1.0, 1.0]);
    let hole = rectangle([0.0, 0.0], [0.1, 0.06]);
    for nodal in [false, true] {
        let of_tank = crate::geometry::points::of_shape::<2>(&tank, spacing(true, nodal));
        let mut rows = rows::<2>(&polygon(&around, &[&hole]), spacing(true, nodal));
        rows.retain(|p| p.position.iter().all(|x| x.abs() < 0.5));
        assert_eq!(rounded(&rows), rounded(&of_tank), "nodal: {nodal}");
    }
}

#[test]
fn rows_behind_a_curved_surface_have_no_gap_and_no_crowd() {
    // A round pillar of radius 8 dx in 60 sides: the first row lies at 7.5 dx.
    let corner = |k: i32| {
        let angle = f64::from(k) * std::f64::consts::TAU / 60.0;
        [0.08 * angle.cos(), 0.08 * angle.sin()]
    };
    let outline: Vec<[f64; 2]> = (0..60).map(corner).collect();
    let points = rows::<2>(&polygon(&outline, &[]), spacing(true, false));
    let radius = |p: &Point<2>| libm::hypot(p.position[0], p.position[1]) / DX;
    let mut angles: Vec<f64> = points
        .iter()
        .filter(|p| radius(p) > 7.2)
        .map(|p| libm::atan2(p.position[1], p.position[0]))
        .collect();
    angles.sort_by(f64::total_cmp);
    // 2 pi 7.5 = 47.1 spacings.
    assert_eq!(angles.len(), 47);
    let widest = angles.windows(2).map(|pair| 7.5 * (pair[1] - pair[0])).fold(0.0, f64::max);
    assert!(widest < 1.02, "{widest}");
    assert!(points.iter().all(|p| !p.corner && radius(p) > 5.0), "three rows");
    let outward = |p: &Point<2>| (p.position[0] * p.normal[0] + p.position[1] * p.normal[1]) / DX / radius(p);
    assert!(points.iter().all(|p| outward(p) > 0.99));
}

#[test]
fn thickness_is_measured_between_faces() {
    let (width, at) = polygon(&rectangle([0.0, 0.0], [0.5, 0.02]), &[]).thickness();
    assert!((width - 0.02).abs() < 1e-12 && (at[1] - 0.01).abs() < 1e-12);
    // A U of walls 0.03 and a floor of 0.05: the gap between the walls, 0.04, is no thickness.
    let u = [
        [0.0, 0.0],
        [0.1, 0.0],
        [0.1, 0.3],
        [0.07, 0.3],
        [0.07, 0.05],
        [0.03, 0.05],
        [0.03, 0.3],
        [0.0, 0.3],
    ];
    assert!((polygon(&u, &[]).thickness().0 - 0.03).abs() < 1e-12);
    // Between a hole and the outline.
    let holed = polygon(&rectangle([0.0, 0.0], [0.3, 0.3]), &[&rectangle([0.1, 0.1], [0.2, 0.285])]);
    let (thin, at) = holed.thickness();
    assert!((thin - 0.015).abs() < 1e-12 && (at[1] - 0.2925).abs() < 1e-12, "{thin} at {at:?}");
    // No sides face each other: 2 * 0.005 / 0.1414.
    let triangle = polygon(&[[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]], &[]);
    assert!((triangle.thickness().0 - 0.01 / 0.02_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_disc_of_many_sides_is_as_thick_as_it_is_wide() {
    let corner = |k: i32| {
        let angle = f64::from(k) * std::f64::consts::TAU / 200.0;
        [angle.cos(), angle.sin()]
    };
    let outline: Vec<[f64; 2]> = (0..200).map(corner).collect();
    let thickness = polygon(&outline, &[]).thickness().0;
    assert!((1.9..2.0).contains(&thickness), "{thickness}");
}

#[test]
fn orientation_does_not_matter() {
    let mut clockwise = rectangle([0.0, 0.0], [0.3, 0.2]);
    clockwise.reverse();
    let hole = rectangle([0.1, 0.1], [0.2, 0.15]);
    let polygon = polygon(&clockwise, &[&hole]);
    assert!((polygon.area() - (0.06 - 0.005)).abs() < 1e-15);
    let edges = Edges::new(&polygon);
    assert!(edges.contains(&[0.05, 0.12], 0.0) && !edges.contains(&[0.15, 0.12], 0.0));
    assert!(edges.contains(&[0.101, 0.12], 0.002) && !edges.contains(&[0.099, 0.12], -0.002));
}

#[test]
fn lines_that_bound_no_region_are_refused_with_the_place() {
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let cross =
        "crosses or touches itself at [0.5, 0.5]: the sides from corner 0 and from corner 2 meet there";
    assert_eq!(fault(&bow, &[]), cross);
    assert_eq!(fault(&[[0.0, 0.0], [1.0, 0.0]], &[]), "has 2 corners; at least 3 bound a region");
    assert_eq!(
        fault(&[[0.0; 2], [1.0, 1.0], [2.0, 2.0]], &[]),
        "bounds no area: its corners lie on one line"
    );
    assert_eq!(
        fault(&[[0.0; 2], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &[]),
        "has corner 1 twice in a row, [1, 0]"
    );
    // A spike that folds back on itself.
    let spike = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    assert!(fault(&spike, &[]).starts_with("crosses or touches itself at [1, 0]"), "{}", fault(&spike, &[]));
    let square = rectangle([0.0, 0.0], [1.0, 1.0]);
    assert_eq!(fault(&square, &[&rectangle([2.0, 2.0], [3.0, 3.0])]), "does not lie in the polygon");
    let out = fault(&square, &[&rectangle([0.5, 0.5], [1.5, 0.7])]);
    assert_eq!(out, "crosses or touches the outline at [1, 0.5]");
    let nested = [&rectangle([0.1, 0.1], [0.9, 0.9])[..], &rectangle([0.4, 0.4], [0.6, 0.6])[..]];
    assert_eq!(fault(&square, &nested), "lies in hole 0");
}

#[test]
fn a_wedge_on_a_floor_is_set_into_it() {
    // The slope 3 : 4 goes on to (-0.16 / 3, -0.04), and behind an upright wall to (0.44, 0.33).
    let wedge = polygon(&[[0.0, 0.0], [0.4, 0.0], [0.4, 0.3]], &[]);
    let floor = |p: &[f64; 2]| (-0.5..=0.5).contains(&p[0]) && (-0.04 - 1e-9..=1e-9).contains(&p[1]);
    let wall = |p: &[f64; 2], top: f64| p[0] >= 0.4 - 1e-9 && p[0] <= 0.5 && (-0.1..=top).contains(&p[1]);
    let high = |p: &[f64; 2]| wall(p, 1.0) || floor(p);
    // The slope would come out of it at its upper end.
    let low = |p: &[f64; 2]| wall(p, 0.31) || floor(p);
    let tip = [-0.16 / 3.0, -0.04];
    let on_floor = [tip, [0.4, -0.04], [0.4, 0.3]];
    let on_both = [tip, [0.44, -0.04], [0.44, 0.33]];
    for (held, expected) in
        [(&floor as &dyn Fn(&[f64; 2]) -> bool, on_floor), (&low, on_floor), (&high, on_both)]
    {
        let [set, rows] = standing::set_into(&wedge, 0.04, DX, held).expect("it stands on walls");
        for (found, expected) in set.outline.iter().zip(expected) {
            assert!((0..2).all(|a| (found[a] - expected[a]).abs() < 1e-12), "{found:?} {expected:?}");
        }
        assert!((rows.outline[0][1] + 0.16).abs() < 1e-12, "four times as deep: {rows:?}");
    }
    let above = |p: &[f64; 2]| p[1] < -0.02 && floor(p);
    assert_eq!(standing::set_into(&wedge, 0.04, DX, above), None, "it does not stand on the floor");
    let short = |p: &[f64; 2]| p[0] > 0.02 && floor(p);
    assert_eq!(standing::set_into(&wedge, 0.04, DX, short), None, "a part of its side lies on no wall");
    let block = polygon(&rectangle([0.0, 0.0], [0.3, 0.2]), &[]);
    assert_eq!(standing::set_into(&block, 0.04, DX, floor), None, "no wedge");
}

/// Shifted, turned or both, a beach has the same particles.
#[test]
fn a_beach_that_is_shifted_and_turned_is_set_in_alike() {
    let walls = |beach: &str| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
             phase = \"fluid\"\nbox = {{ min = [0.0, 0.2], max = [0.3, 0.3] }}\n[[shape]]\nname = \"beach\"\n\
             phase = \"wall\"\n{beach}\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
             tank = {{ min = [0.0, 0.0], max = [1.0, 0.5], open = [\"top\"] }}\n"
        );
        let scene = crate::parse(&text, std::path::Path::new("beach.toml"), &[]).expect("a scene");
        crate::geometry::layout::<2>(&scene).wall
    };
    let plain = walls("polygon = [[0.4, 0.0], [1.0, 0.0], [1.0, 0.2]]");
    for beach in [
        "polygon = [[0.0, 0.0], [0.6, 0.0], [0.6, 0.2]]\ntranslate = [0.4, 0.0]",
        "polygon = [[0.6, 0.2], [0.0, 0.2], [0.0, 0.0]]\nrotate = { angle = 180, about = [0.5, 0.1] }",
    ] {
        let moved = walls(beach);
        assert_eq!(moved.len(), plain.len(), "{beach}");
        for (a, b) in plain.iter().zip(&moved) {
            let near = |a: [f64; 2], b: [f64; 2]| (0..2).all(|d| (a[d] - b[d]).abs() < 1e-9);
            assert!(near(a.position, b.position) && near(a.normal, b.normal), "{beach}: {a:?} {b:?}");
        }
    }
    let leaning = walls("polygon = [[0.4, 0.0], [1.0, 0.0], [1.0, 0.2]]\ntranslate = [0.0, 0.004]");
    assert_ne!(leaning.len(), plain.len(), "0.4 dx above the floor it does not stand on it");
}

/// Below the surface of a beach whose tip lies on the floor, whichever stands first in the scene, walls are filled as
/// far as the kernel reaches: the farthest place from any particle of a lattice is 0.71 dx away, where two lattices
/// meet somewhat more.
#[test]
fn the_tip_of_a_beach_has_no_gaps() {
    let beach =
        "[[shape]]\nname = \"beach\"\nphase = \"wall\"\npolygon = [[0.5, 0.0], [1.6, 0.0], [1.6, 0.2947]]\n";
    let tank = "[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
        tank = { min = [0.0, 0.0], max = [1.6, 0.8], open = [\"top\"] }\n";
    for shapes in [[beach, tank], [tank, beach]] {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
             phase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.3, 0.3] }}\n{}",
            shapes.concat()
        );
        let scene = crate::parse(&text, std::path::Path::new("beach.toml"), &[]).expect("a scene");
        let walls = crate::geometry::layout::<2>(&scene).wall;
        let (sin, cos) = (0.2947_f64 / 1.1).atan().sin_cos();
        let mut farthest = 0.0_f64;
        for i in 0..200 {
            for depth in (1..=7).map(|k| 0.5 * f64::from(k) * DX) {
                let along = 0.005 * f64::from(i);
                let at = [0.5 + along * cos + depth * sin, along * sin - depth * cos];
                let apart = |p: &crate::geometry::WallPoint<2>| {
                    libm::hypot(p.position[0] - at[0], p.position[1] - at[1])
                };
                farthest = farthest.max(walls.iter().map(apart).fold(f64::INFINITY, f64::min));
            }
        }
        println!("{:.3} dx from the nearest particle", farthest / DX);
        assert!(farthest < 0.9 * DX, "{} dx", farthest / DX);
    }
}
