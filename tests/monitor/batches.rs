//! Several changes together: all of them are made, or none.

use super::scenarios::{head_on, kinds, tick, two};
use super::support::{bits, line};
use glam::{DQuat, DVec3};
use nearmiss::{AlertLevel, Body, BodyId, Command, Error, Hitbox, Monitor, Orientation};

/// Returns the error of a command about an unknown body.
fn unknown_in(command: usize, id: BodyId) -> Error {
    let error = Box::new(Error::UnknownBody { id });
    Error::InCommand { command, error }
}

#[test]
fn a_batch_is_all_or_nothing() {
    let (a, b) = head_on();
    let (mut monitor, id, other) = two(a.clone(), b, &[AlertLevel::at(2.0)]);
    tick(&mut monitor, 0.0);
    let before = bits(monitor.conflicts(0).unwrap());
    let refused = monitor.apply([
        Command::Remove(other),
        Command::Insert(Body::new(a.clone())),
        Command::SetHitbox(other, Hitbox::POINT),
    ]);
    assert_eq!(refused.unwrap_err(), unknown_in(2, other));
    // A new body without a tag has no name but the number of its command.
    let ground = Body::new(a.clone()).with_hitbox(Hitbox::half_space(DVec3::Z).unwrap());
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::X).unwrap();
    let bodies = [ground.clone(), ground.with_orientation(spin)];
    let refused = monitor.apply(bodies.map(Command::Insert)).unwrap_err();
    let message = "command 1: body 0: a half-space cannot turn";
    assert!(refused.to_string().starts_with(message), "{refused}");
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), [""; 0]);
    assert_eq!(bits(monitor.conflicts(0).unwrap()), before);
    let gap = line(40.0, 50.0, DVec3::ZERO, DVec3::X);
    assert!(monitor.replan(id, 5.0, gap).is_err());
    assert_eq!(bits(monitor.conflicts(0).unwrap()), before);
    let inserted = monitor
        .apply([Command::Remove(other), Command::Insert(Body::new(a))])
        .unwrap();
    assert_eq!(inserted.len(), 1);
    assert_eq!(monitor.scene().len(), 2);
}

#[test]
fn pairs_are_ignored_with_other_changes_or_not_at_all() {
    let (a, b) = head_on();
    let (mut monitor, id, other) = two(a.clone(), b, &[AlertLevel::at(2.0)]);
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), ["predicted 0"]);
    let ignored = |monitor: &Monitor| monitor.scene().ignored_pairs().count();
    // What is removed has no pairs; and nobody is a pair with itself.
    for refused in [
        [
            Command::IgnorePair(id, other),
            Command::UnignorePair(other, other),
        ],
        [Command::Remove(other), Command::IgnorePair(other, id)],
    ] {
        assert!(monitor.apply(refused).is_err());
        assert_eq!((ignored(&monitor), monitor.scene().len()), (0, 2));
    }
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), [""; 0]);
    monitor.apply([Command::IgnorePair(other, id)]).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), ["withdrawn 0"]);
    // In their order; and with a body that goes its pairs go.
    let twice = [
        Command::UnignorePair(id, other),
        Command::IgnorePair(id, other),
    ];
    monitor.apply(twice).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), [""; 0]);
    monitor.apply([Command::UnignorePair(id, other)]).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), ["predicted 0"]);
    let both = [Command::IgnorePair(id, other), Command::Remove(other)];
    monitor.apply(both).unwrap();
    assert_eq!((ignored(&monitor), monitor.scene().len()), (0, 1));
}

/// A shot is inserted where its ship is.
#[test]
fn a_new_body_ignores_others_from_the_beginning() {
    let (a, b) = head_on();
    let (mut monitor, ship, target) = two(a.clone(), b, &[AlertLevel::at(2.0)]);
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), ["predicted 0"]);
    let ignored = |monitor: &Monitor| -> Vec<_> { monitor.scene().ignored_pairs().collect() };
    let shot = |owner| Command::InsertIgnoring(Body::new(a.clone()), vec![owner]);
    // One that is gone by then is not known; nothing is changed then.
    let refused = monitor.apply([shot(ship), Command::Remove(target), shot(target)]);
    assert_eq!(refused.unwrap_err(), unknown_in(2, target));
    assert_eq!((ignored(&monitor), monitor.scene().len()), (vec![], 2));
    let shots = monitor.apply([shot(ship)]).unwrap();
    assert_eq!(ignored(&monitor), [(ship, shots[0])]);
    // It meets the target as its ship does, and not the ship.
    let events = tick(&mut monitor, 0.0);
    assert_eq!(kinds(&events), ["predicted 0"]);
    let met = monitor.conflicts_of(shots[0], 0).unwrap();
    let met: Vec<_> = met.map(|one| one.other(shots[0])).collect();
    assert_eq!(met, [Some(target)]);
    // One that goes later in the same batch leaves no pair behind.
    let next = monitor
        .apply([shot(target), Command::Remove(target)])
        .unwrap();
    assert_eq!(next.len(), 1);
    assert_eq!(ignored(&monitor), [(ship, shots[0])]);
}
