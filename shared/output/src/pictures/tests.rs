//! The pictures, decoded again: size, colours, and what a viewer must find on them.

use super::plot::{CURVES, HEAD, REFERENCES};
use super::stamp::{Scale, WALL, palette};
use super::timeline::{COMPUTE, WAIT};
use super::*;
use crate::timeline::{HALF_STEP, Span, Timeline, Track};
use crate::{ProbeLog, series};
use std::collections::HashMap;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Folder of a drawn run; it stays for people to look at.
fn folder(name: &str) -> PathBuf {
    let target = std::env::current_exe().unwrap();
    let dir = target.ancestors().nth(3).unwrap().join("tmp/pictures").join(name);
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    dir
}

/// Width, height and the pixels.
fn pixels(path: &Path) -> (u32, u32, Vec<[u8; 3]>) {
    let mut decoder = png::Decoder::new(BufReader::new(std::fs::File::open(path).unwrap()));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    pixels.truncate(info.buffer_size());
    (info.width, info.height, pixels.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect())
}

/// Width, height and how often each RGB colour appears.
fn decode(path: &Path) -> (u32, u32, HashMap<[u8; 3], u32>) {
    let (width, height, pixels) = pixels(path);
    let mut colors = HashMap::new();
    pixels.into_iter().for_each(|pixel| *colors.entry(pixel).or_default() += 1);
    (width, height, colors)
}

fn rgb(color: plotters::style::RGBColor) -> [u8; 3] {
    [color.0, color.1, color.2]
}

#[test]
fn the_plot_shows_curves_and_references() {
    let dir = folder("plot");
    let plain = folder("plot-plain");
    let mut scene = fixture::scene();
    fixture::probes(&scene, &plain);
    fixture::probes(&scene, &dir);
    let path = draw_plot(&scene, &dir).unwrap();
    assert_eq!(path, dir.join("plot.png"));
    let (width, height, with) = decode(&path);
    // Three panels below each other: tip.x and tip.y have references, the pressure is alone.
    assert_eq!((width, height), (1000, HEAD + 3 * 400));
    let count = |colors: &HashMap<[u8; 3], u32>, color| colors.get(&rgb(color)).copied().unwrap_or(0);
    assert!(count(&with, CURVES[0]) > 1000);
    assert!(count(&with, REFERENCES[0]) > 100 && count(&with, REFERENCES[1]) > 100);
    assert_eq!(count(&with, CURVES[1]), 0);

    scene.references.clear();
    let (_, height, without) = decode(&draw_plot(&scene, &plain).unwrap());
    assert_eq!(height, HEAD + 2 * 400, "the components of the tip share a panel");
    assert!(count(&without, CURVES[0]) > 1000 && count(&without, CURVES[1]) > 300);
    assert_eq!(count(&without, REFERENCES[1]), 0);
}

#[test]
fn a_run_that_diverged_or_measured_nothing_still_has_a_plot() {
    let dir = folder("plot-diverged");
    let mut scene = fixture::scene();
    let columns: Vec<String> = scene.probes.iter().flat_map(|probe| probe.columns(2)).collect();
    let mut log = ProbeLog::create(&dir.join("probes.csv"), &columns).unwrap();
    for (time, value) in [(0.0, 0.0), (0.1, 0.02), (0.2, f64::NAN), (0.3, f64::INFINITY), (0.4, 0.01)] {
        log.row(time, &[value, -value, 1e5 * value]).unwrap();
    }
    let (.., colors) = decode(&draw_plot(&scene, &dir).unwrap());
    assert!(colors[&rgb(CURVES[0])] > 100);

    scene.probes.clear();
    scene.references.clear();
    ProbeLog::create(&dir.join("probes.csv"), &[]).unwrap();
    let (width, _, colors) = decode(&draw_plot(&scene, &dir).unwrap());
    assert_eq!(width, 1000);
    assert!(!colors.contains_key(&rgb(CURVES[0])));
}

fn pressure(k: u32) -> halfstep_scene::Probe {
    halfstep_scene::Probe {
        name: format!("p{k}"),
        kind: halfstep_scene::ProbeKind::Pressure { at: [0.0; 3], to: None, shape: None },
        solid: None,
    }
}

#[test]
fn many_probes_share_a_picture_in_columns() {
    let dir = folder("plot-many");
    let mut scene = fixture::scene();
    scene.references.clear();
    scene.probes.extend((1..=4).map(pressure));
    let columns: Vec<String> = scene.probes.iter().flat_map(|probe| probe.columns(2)).collect();
    let mut log = ProbeLog::create(&dir.join("probes.csv"), &columns).unwrap();
    for k in 0..=400 {
        let time = f64::from(k) * 0.001;
        let wave = |k: u32| 4000.0 * (30.0 * time + f64::from(k)).sin();
        log.row(time, &[time, 0.0, wave(0), wave(1), wave(2), wave(3), 1e3 * wave(4)]).unwrap();
    }
    let (width, height, _) = decode(&draw_plot(&scene, &dir).unwrap());
    assert_eq!((width, height), (1520, HEAD + 4 * 340), "seven panels");
}

/// Nobody reads thousands, and they would ask for more memory than there is.
#[test]
fn the_first_48_of_many_panels_are_drawn() {
    let dir = folder("plot-thousands");
    let mut scene = fixture::scene();
    scene.references.clear();
    scene.probes = (0..3000).map(pressure).collect();
    let columns: Vec<String> = scene.probes.iter().flat_map(|probe| probe.columns(2)).collect();
    let mut log = ProbeLog::create(&dir.join("probes.csv"), &columns).unwrap();
    for k in 0..3 {
        log.row(0.1 * f64::from(k), &vec![f64::from(k); 3000]).unwrap();
    }
    let (width, height, _) = decode(&draw_plot(&scene, &dir).unwrap());
    assert_eq!((width, height), (3 * 760, HEAD + 16 * 340));
}

/// Pixels of the oversampled plot that are drawn in a colour.
fn drawn(canvas: &canvas::Canvas, color: plotters::style::RGBColor) -> Vec<(i32, i32)> {
    let width = canvas.width as i32;
    let pixels = (0_i32..).zip(canvas.rgb.chunks_exact(3)).filter(|(_, pixel)| **pixel == rgb(color));
    pixels.map(|(k, _)| (k % width, k / width)).collect()
}

fn holds(rect: stamp::Rect, &(x, y): &(i32, i32)) -> bool {
    (rect.x..=rect.x + rect.width).contains(&x) && (rect.y..=rect.y + rect.height).contains(&y)
}

/// A scene with gauges in one panel for each list, and what they measured at 400 instants.
fn gauges(
    lists: &[usize],
    level: impl Fn(usize, f64) -> f64,
) -> (halfstep_scene::Scene, crate::probes::Table) {
    let mut scene = fixture::scene();
    scene.references.clear();
    let gauge = |(k, count): (usize, &usize)| halfstep_scene::Probe {
        name: format!("gauge{k}"),
        kind: halfstep_scene::ProbeKind::WaterLevel { x: vec![0.0; *count] },
        solid: None,
    };
    scene.probes = lists.iter().enumerate().map(gauge).collect();
    let columns = scene.probes.iter().flat_map(|probe| probe.columns(2));
    let columns: Vec<_> = std::iter::once("time [s]".to_string()).chain(columns).collect();
    let value = |k: usize, time: f64| if k == 0 { time } else { level(k - 1, time) };
    let rows = (0..=400).map(|instant| f64::from(instant) * 0.001);
    let rows = rows.map(|time| (0..columns.len()).map(|k| value(k, time)).collect()).collect();
    (scene, crate::probes::Table { columns, rows })
}

/// Up and down at each instant, over a wave, so that turns have any angle.
fn zigzag(k: usize, time: f64) -> f64 {
    let instant = (time * 1e3).round();
    let up = if (instant as usize).is_multiple_of(2) { 1.0 } else { -1.0 };
    up * (1.0 + 0.8 * (0.3 * instant).sin() * (0.011 * instant * (k + 1) as f64).cos())
}

#[test]
fn curves_stay_in_their_panel() {
    let (scene, table) = gauges(&[1, 1, 1], |k, time| if k == 1 { time } else { zigzag(k, time) });
    let (canvas, places) = plot::paint(&scene, &table).unwrap();
    assert_eq!(places.len(), 3);
    let pixels = drawn(&canvas, CURVES[0]);
    assert!(pixels.len() > 10_000);
    assert!(pixels.iter().all(|pixel| places.iter().any(|place| holds(place.plot, pixel))));
    // The slow curve in the middle stays alone: a straight line, four pixels wide.
    let between = pixels.iter().filter(|pixel| holds(places[1].plot, pixel)).count();
    let [width, height] = [places[1].plot.width, places[1].plot.height].map(f64::from);
    assert!((between as f64 / (4.0 * width.hypot(height / 1.12)) - 1.0).abs() < 0.05, "{between}");
}

#[test]
fn curves_of_a_panel_differ_in_colour() {
    let (scene, table) = gauges(&[CURVES.len()], |k, time| k as f64 + (9.0 * time).sin());
    let (canvas, _) = plot::paint(&scene, &table).unwrap();
    for color in CURVES {
        assert!(drawn(&canvas, color).len() > 3000, "{color:?}");
    }
    let all = [&CURVES[..], &REFERENCES[..]].concat();
    for (k, a) in all.iter().enumerate() {
        for b in &all[k + 1..] {
            let square = |a: u8, b: u8| (f64::from(a) - f64::from(b)).powi(2);
            let distance = (square(a.0, b.0) + square(a.1, b.1) + square(a.2, b.2)).sqrt();
            assert!(distance > 50.0, "{a:?} {b:?}");
        }
    }
}

#[test]
fn ticks_tell_values_apart() {
    let ticks = [(0.0, 9), (2.5e-11, 9), (0.2998001, 7), (12.5, 1), (2e7, 0)];
    let ticks = ticks.map(|(value, digits)| plot::tick(value, digits));
    assert_eq!(ticks, ["0", "2.50e-11", "0.2998001", "12.5", "2.00e7"]);
}

/// Curves go everywhere but to the lower right: the legend is there, and the axis as it was; curves that go everywhere
/// leave it a strip above them.
#[test]
fn the_legend_hides_no_curve() {
    let rises = |k: usize, time: f64| if time < 0.2 { zigzag(k, time) } else { 0.9 + 0.1 * zigzag(k, time) };
    for everywhere in [false, true] {
        let (scene, table) =
            gauges(&[4], |k, time| if everywhere { zigzag(k, time) } else { rises(k, time) });
        let (canvas, places) = plot::paint(&scene, &table).unwrap();
        let (plot, legend) = (places[0].plot, places[0].legend.unwrap());
        let pixels: Vec<_> = CURVES[..4].iter().flat_map(|&color| drawn(&canvas, color)).collect();
        let highest = pixels.iter().filter(|pixel| !holds(legend, pixel)).map(|(_, y)| *y).min().unwrap();
        let bottom = legend.y + legend.height;
        if everywhere {
            assert!(holds(plot, &(legend.x, legend.y)) && highest > bottom, "{highest} {bottom}");
            assert!(f64::from(bottom - plot.y) < 0.3 * f64::from(plot.height));
        } else {
            assert!(legend.x > plot.x + plot.width / 2 && legend.y > plot.y + plot.height / 2);
            assert!(f64::from(highest - plot.y) < 0.1 * f64::from(plot.height));
        }
        // Samples alone have a curve's colour in it: four of 60 by 4 pixels.
        let samples = pixels.iter().filter(|pixel| holds(legend, pixel)).count();
        assert!((900..=1100).contains(&samples), "{samples}");
    }
}

#[test]
fn the_contact_sheet_shows_all_phases_in_their_colours() {
    let dir = folder("contact");
    let scene = fixture::scene();
    assert_eq!(draw_contact(&scene, &dir).unwrap(), None, "no frames, no picture");
    fixture::frames(&dir, 21);
    let path = draw_contact(&scene, &dir).unwrap().unwrap();
    let (width, height, colors) = decode(&path);
    assert!((1200..=1700).contains(&width) && (400..=1310).contains(&height), "{width} x {height}");
    let palette = palette();
    let pixels = |index: u8| {
        let at = 3 * usize::from(index);
        colors.get(&palette[at..at + 3]).copied().unwrap_or(0)
    };
    // Wall particles cover as much of each panel as their number says: 750 of them in six panels.
    let view = [0.298, 0.144].map(|length| length + 3.0 * fixture::SPACING);
    let scale = view::layout(6, view, contact::HEAD, contact::FOOT, fixture::SPACING).scale;
    let expected = 6.0 * 750.0 * (scale * fixture::SPACING).powi(2);
    let share = f64::from(pixels(WALL)) / expected;
    assert!((0.95..1.2).contains(&share), "{share}");
    let covered = |scale: Scale| (0..=100).map(|k| scale.index(f64::from(k) / 100.0)).collect::<Vec<_>>();
    for scale in [Scale::Fluid, Scale::Solid] {
        let seen = covered(scale).iter().filter(|&&index| pixels(index) > 40).count();
        assert!(seen > 50, "{scale:?}: only {seen} of its colours appear");
    }
    // A drop thirty metres away does not shrink the view: the water covers a good part of the picture.
    let fluid: u32 = covered(Scale::Fluid)
        .iter()
        .collect::<std::collections::HashSet<_>>()
        .iter()
        .map(|&&k| pixels(k))
        .sum();
    assert!(f64::from(fluid) > 0.1 * f64::from(width * height), "{fluid}");
}

/// The upper half of a plate is cracked: as many pixels are black as it covers, beside those of labels.
#[test]
fn cracked_particles_are_black() {
    let black = |cracked: usize| {
        let dir = folder(&format!("contact-cracked-{cracked}"));
        fixture::cracked_gate(&dir, cracked);
        let (.., colors) = decode(&draw_contact(&fixture::scene(), &dir).unwrap().unwrap());
        let dark = usize::from(stamp::DARK) * 3;
        f64::from(colors.get(&palette()[dark..dark + 3]).copied().unwrap_or(0))
    };
    let [none, half, all] = [0, 60, 120].map(black);
    assert!(half - none > 1000.0, "{none} {half}");
    assert!(((all - none) / (half - none) / 2.0 - 1.0).abs() < 0.1, "{none} {half} {all}");
}

#[test]
fn one_frame_of_one_phase_is_enough_for_a_sheet() {
    let dir = folder("contact-solid");
    fixture::frames(&dir, 1);
    std::fs::remove_file(series::frames_folder(&dir).join(series::index_name("fluid"))).unwrap();
    let path = draw_contact(&fixture::scene(), &dir).unwrap().unwrap();
    let (width, _, colors) = decode(&path);
    assert!(width >= 700);
    let palette = palette();
    let color = |index: u8| [0, 1, 2].map(|c| palette[3 * usize::from(index) + c]);
    assert!(colors[&color(Scale::Solid.index(0.0))] > 1000);
    assert!(!colors.contains_key(&color(WALL)));
    assert!(!colors.contains_key(&color(Scale::Fluid.index(0.5))));
}

#[test]
fn a_scene_is_drawn_before_its_run() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/two-plates.toml");
    let scene = halfstep_scene::load(&path, &[]).unwrap();
    let picture = folder("start").join("start.png");
    draw_start(&scene, &picture).unwrap();
    let (_, _, colors) = decode(&picture);
    let palette = palette();
    let pixels = |index: u8| {
        let color = [0, 1, 2].map(|c| palette[3 * usize::from(index) + c]);
        f64::from(colors.get(&color).copied().unwrap_or(0))
    };
    // 2701 fluid particles, two plates of 60 free ones and 12 clamped ones each, and nothing that moves.
    let particle = pixels(start::water()) / 2701.0;
    for (body, particles) in [(0, 60.0), (1, 60.0)] {
        let share = pixels(start::body_color(body)) / (particles * particle);
        assert!((0.9..1.2).contains(&share), "{body}: {share}");
    }
    // The lines and letters are black as well.
    assert!((1.0..1.6).contains(&(pixels(start::CLAMPED) / (24.0 * particle))));
    assert!(pixels(WALL) > 1000.0 * 0.9 * particle);
    let empty = halfstep_scene::Scene { shapes: Vec::new(), ..scene };
    assert!(draw_start(&empty, &picture).unwrap_err().to_string().ends_with("the scene has no particles"));
}

/// What gauges, axes of moments and boxes of forces change in the picture of a scene.
#[test]
fn probes_are_drawn_where_they_measure() {
    use halfstep_scene::{Block, Probe, ProbeKind};
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/two-plates.toml");
    let mut scene = halfstep_scene::load(&path, &[]).unwrap();
    let dir = folder("start-probes");
    let mut draw = |name: &str, kinds: Vec<ProbeKind>| {
        let probe = |kind| Probe { name: "tide".into(), kind, solid: None };
        scene.probes = kinds.into_iter().map(probe).collect();
        let picture = dir.join(name);
        draw_start(&scene, &picture).unwrap();
        pixels(&picture)
    };
    let (width, _, plain) = draw("none.png", Vec::new());
    let changed = |pixels: &[[u8; 3]]| {
        let pairs = (0_u32..).zip(plain.iter().zip(pixels));
        let changed = pairs.filter(|(_, (before, after))| before != after);
        changed.map(|(k, (before, after))| (k % width, k / width, *before, *after)).collect::<Vec<_>>()
    };
    let (black, white) = ([0; 3], [255; 3]);
    let water = [0, 1, 2].map(|c| palette()[3 * usize::from(start::water()) + c]);

    let (_, height, gauges) = draw("gauges.png", vec![ProbeKind::WaterLevel { x: vec![0.05, 0.5, 77.0] }]);
    let gauges = changed(&gauges);
    let mut columns: HashMap<u32, u32> = HashMap::new();
    let lines = gauges.iter().filter(|pixel| pixel.3 == black);
    lines.for_each(|pixel| *columns.entry(pixel.0).or_default() += 1);
    let lines = columns.values().filter(|&&count| count > height / 3).count();
    assert_eq!(lines, 4, "two lines, each two pixels wide; the third gauge is outside");

    let about = [0.05, 0.1, 0.0];
    let within = Block { min: [0.2, 0.1, 0.0], max: [0.5, 0.2, 0.0] };
    let force = ProbeKind::Force { within: Some(within), shape: None };
    let (.., boxed) = draw("within.png", vec![force]);
    // The lines that no label covers are grey.
    let grey = changed(&boxed).into_iter().filter(|pixel| pixel.3 == [85; 3]).collect::<Vec<_>>();
    let extent = |along: fn(u32, u32) -> u32| {
        let all = || grey.iter().map(|pixel| along(pixel.0, pixel.1));
        f64::from(all().max().unwrap() - all().min().unwrap())
    };
    let share = extent(|x, _| x) / extent(|_, y| y);
    assert!((share - 3.0).abs() < 0.1, "{share}");

    let (.., moment) = draw("moment.png", vec![ProbeKind::Moment { about, within: None, shape: None }]);
    let on_water = |color| changed(&moment).iter().filter(|p| p.2 == water && p.3 == color).count();
    assert!((40..200).contains(&on_water(black)), "a cross and letters");
    assert!(on_water(white) > 200, "the name has a ground of its own");

    // Two names at one place stand below each other: twice the ground.
    let ground = |pixels: &[[u8; 3]]| changed(pixels).iter().filter(|pixel| pixel.3 == white).count() as f64;
    let one = ProbeKind::Velocity { at: about };
    let (.., both) = draw("both.png", vec![one.clone(), one]);
    let share = ground(&both) / ground(&moment);
    assert!((1.8..2.1).contains(&share), "{share}");
}

#[test]
fn the_timeline_shows_each_phase_as_long_as_it_was() {
    let span = |name: &str, category: &str, stage, start, duration| Span {
        name: name.into(),
        category: category.into(),
        start,
        duration,
        step: 7,
        stage,
        with: None,
    };
    let spans = vec![
        span("half-step", HALF_STEP, 0, 0.0, 100.0),
        span("sums", "compute", 0, 0.0, 100.0),
        span("half-step", HALF_STEP, 1, 100.0, 300.0),
        span("wait for state", "wait", 1, 100.0, 300.0),
    ];
    let track =
        |k: u32| Track { process: ("fluid".into(), k), name: format!("fluid-{k}"), spans: spans.clone() };
    let path = folder("timeline").join("trace.png");
    for tracks in [1, 3, 12] {
        let timeline = Timeline { tracks: (0..tracks).map(track).collect(), lost: 0 };
        draw_timeline(&fixture::scene(), &timeline, &path).unwrap();
        let (width, _, colors) = decode(&path);
        // The width without margins and names; each bar is 36 pixels high, a colour of the table 22 by 14.
        let bars = f64::from((width - 198) * 36 * tracks);
        for (color, share) in [(COMPUTE[0], 0.25), (WAIT[0], 0.75)] {
            let found = f64::from(colors[&rgb(color)]) - 22.0 * 14.0;
            // Names and lines take some of them.
            assert!((0.93..1.001).contains(&(found / (share * bars))), "{tracks}: {share} {found} of {bars}");
        }
    }
    draw_timeline(&fixture::scene(), &Timeline::default(), &path).unwrap();
}
