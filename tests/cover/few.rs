//! No more spheres than are needed, and none for a worse cover.

use crate::cases::torus;
use crate::{brick, fit};
use nearmiss::parry3d::math::Vector;
use nearmiss::parry3d::shape::{Cuboid, Cylinder, Shape};
use nearmiss::{CoverError, CoverOptions, Coverage, SphereCover};

/// One sphere is best, or as good as more.
#[test]
fn spheres_that_are_not_needed_go() {
    let stout = Cylinder::new(1.0, 1.0);
    let cube = Cuboid::new(Vector::ONE);
    for (shape, counts) in [(&stout as &dyn Shape, 2..=4), (&cube, 2..=3)] {
        let of_one = fit(shape, 1);
        for count in counts {
            let cover = fit(shape, count);
            assert_eq!(cover.spheres().len(), 1, "{count}");
            assert!(cover.overshoot() <= of_one.overshoot(), "{count}");
            assert_eq!(cover.verify(shape).unwrap(), Coverage::Covered);
        }
    }
    // Two spheres of the long cylinder touch its rims, others between them would have no use.
    let cover = fit(&Cylinder::new(1.0, 0.5), 4);
    assert!(cover.spheres().len() < 4, "{cover:?}");
}

/// More spheres than are moved one by one.
#[test]
fn many_spheres_are_no_worse_than_fewer() {
    let torus = torus(96, 48);
    let [fewer, more] = [256, 300].map(|count| fit(&torus, count));
    assert!(more.overshoot() <= fewer.overshoot());
    assert_eq!(more.verify(&torus).unwrap(), Coverage::Covered);
}

/// Four spheres are no better than two: the error names the better ones.
#[test]
fn the_best_cover_misses_the_target() {
    let options = CoverOptions::new(4).with_target_overshoot(0.01);
    for shape in [&Cylinder::new(1.0, 0.5) as &dyn Shape, &brick()] {
        let covers = [1, 2, 4].map(|count| fit(shape, count));
        let best = covers
            .iter()
            .min_by(|a, b| a.overshoot().total_cmp(&b.overshoot()));
        let best = best.unwrap();
        let refused = SphereCover::fit(shape, &options);
        let Err(CoverError::TargetMissed {
            spheres, overshoot, ..
        }) = refused
        else {
            panic!("{refused:?}");
        };
        assert_eq!(spheres, best.spheres().len());
        assert!(overshoot <= best.overshoot() && overshoot >= best.overshoot());
    }
}
