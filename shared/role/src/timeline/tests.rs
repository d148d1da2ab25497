use super::*;
use std::rc::Rc;

fn at(step: u64, stage: Stage) -> HalfStep {
    HalfStep { stage, ..HalfStep::begin(step, 0.0) }
}

/// A recording of a window, and where its part goes.
fn recorded(window: &str) -> (Recording, Rc<RefCell<Vec<Part>>>) {
    let parts = Rc::new(RefCell::new(Vec::new()));
    let to = Rc::clone(&parts);
    (record(window.parse().unwrap(), Box::new(move |part| to.borrow_mut().push(part))), parts)
}

fn play(steps: std::ops::Range<u64>) {
    for half_step in steps.flat_map(|n| [at(n, Stage::First), at(n, Stage::Second)]) {
        let began = begin(&half_step, 1);
        {
            let _turn = turn(Name::FLUID);
            let outer = Watch::start(Kind::Compute, "sums");
            drop(phase("pair pass"));
            outer.stop();
        }
        end(Name::FLUID, began);
    }
}

#[test]
fn nothing_is_recorded_unless_it_is_asked_for() {
    play(0..3);
    assert!(begin(&at(0, Stage::First), 1).is_none() && !is_on());
    assert_eq!(phase("sums").start, None);
}

#[test]
fn a_window_is_delivered_when_it_has_passed_and_only_once() {
    let (recording, parts) = recorded("2..4");
    play(0..4);
    assert!(parts.borrow().is_empty(), "the window may go on");
    play(4..6);
    drop(recording);
    let parts = parts.borrow();
    let [part] = parts.as_slice() else { panic!("{} parts", parts.len()) };
    let all: Vec<_> = part.events.iter().map(|e| (e.step, e.stage.number(), e.what)).collect();
    let of = |step, stage| ["pair pass", "sums", "half-step"].map(|what| (step, stage, what));
    assert_eq!(all, [of(2, 0), of(2, 1), of(3, 0), of(3, 1)].concat());
    assert!(part.events.iter().all(|event| event.track == Name::FLUID && event.span[0] <= event.span[1]));
    for nested in part.events.chunks(3) {
        let [inner, outer, whole] = nested else { panic!("three a half-step") };
        assert!(whole.span[0] <= outer.span[0] && outer.span[0] <= inner.span[0], "{nested:?}");
        assert!(inner.span[1] <= outer.span[1] && outer.span[1] <= whole.span[1], "{nested:?}");
    }
}

#[test]
fn a_recording_that_ends_early_delivers_what_it_has() {
    let (recording, parts) = recorded("1..100");
    play(0..3);
    drop(recording);
    assert_eq!(parts.borrow()[0].events.len(), 2 * 2 * 3);
    assert!(!is_on());
}

#[test]
fn the_turn_goes_back() {
    let (recording, parts) = recorded("0..9");
    let began = begin(&at(0, Stage::First), 2);
    let fluid = turn(Name::FLUID);
    {
        let _coupler = turn(Name::COUPLER);
        drop(phase("checks"));
    }
    drop(phase("sums"));
    drop(fluid);
    end(Name::SOLID, began);
    drop(recording);
    let tracks: Vec<Name> = parts.borrow()[0].events.iter().map(|event| event.track).collect();
    assert_eq!(tracks, [Name::COUPLER, Name::FLUID, Name::SOLID]);
}

#[test]
fn the_links_account_tells_waiting_from_taking_over() {
    let (recording, parts) = recorded("0..9");
    begin(&at(0, Stage::First), 1);
    let mut link = LinkTimes::default();
    let sleep = Duration::from_millis(2);
    let taken = receive(
        &mut link,
        "wait for state",
        Name::SOLID,
        |link| *link,
        |link| {
            std::thread::sleep(2 * sleep);
            link.wait += sleep;
            7
        },
    );
    receive(&mut link, "wait for forces", Name::COUPLER, |link| *link, |_| ());
    drop(recording);
    assert_eq!(taken, 7);
    let events = parts.borrow()[0].events.clone();
    let told: Vec<_> = events.iter().map(|event| (event.kind, event.what)).collect();
    let receive = (Kind::Message, "receive");
    assert_eq!(told, [(Kind::Wait, "wait for state"), receive, (Kind::Wait, "wait for forces")]);
    assert_eq!(events[0].span[1] - events[0].span[0], sleep.as_nanos() as u64);
    assert_eq!(events[0].span[1], events[1].span[0]);
}

#[test]
fn the_room_is_bounded_and_half_steps_are_kept() {
    let (recording, parts) = recorded("0..1");
    let began = begin(&at(0, Stage::First), 1);
    (0..MOST_EVENTS + 5).for_each(|_| drop(phase("sub-step")));
    end(Name::SOLID, began);
    drop(recording);
    let parts = parts.borrow();
    assert_eq!((parts[0].events.len(), parts[0].lost), (MOST_EVENTS + 1, 5));
    assert_eq!(parts[0].events.last().unwrap().kind, Kind::HalfStep);
}

#[test]
fn windows_are_read_and_refused() {
    let window: Window = "100..120".parse().unwrap();
    assert_eq!((window.first(), window.last(), window.steps()), (100, 119, 20));
    assert_eq!(window.to_string(), "100..120");
    assert_eq!([99, 100, 119, 120].map(|step| window.place(step) as i8), [-1, 0, 0, 1]);
    let refused = |text: &str| text.parse::<Window>().unwrap_err();
    assert_eq!(refused("9..9"), BadWindow::Empty { from: 9, to: 9 });
    assert_eq!(refused("9..2"), BadWindow::Empty { from: 9, to: 2 });
    assert_eq!(refused("0..1001"), BadWindow::Long { from: 0, to: 1001 });
    for text in ["", "5", "a..b", "-1..3", "1...3", "1..2..3"] {
        assert_eq!(refused(text), BadWindow::Form(text.into()));
    }
}
