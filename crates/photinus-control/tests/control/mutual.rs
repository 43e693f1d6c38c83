//! Mutual localization against Monte Carlo, a bound that shares no code with it, and brute force.

use core::f64::consts::PI;

use nalgebra::{DMatrix, Matrix3, Rotation3, UnitVector3, Vector3};
use photinus_control::Normal;
use photinus_control::mutual::{Report, Sight, Unclear, heading_from_bearing, locate};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::flight::{between, uniform};

/// Range and bearing noise of a view: two hundredths of the distance, and half a pixel.
const ALONG: f64 = 0.02;
const ACROSS: f64 = 0.002;

struct Truth {
    places: Vec<Vector3<f64>>,
    headings: Vec<f64>,
}

impl Truth {
    /// Vehicles in a box of 20 m by 20 m by 6 m, 3 m apart; the first one is in the middle and looks along x.
    fn random(rng: &mut Pcg64Mcg, vehicles: usize) -> Self {
        let mut places = vec![Vector3::zeros()];
        while places.len() < vehicles {
            let p =
                Vector3::new(between(rng, -10.0, 10.0), between(rng, -10.0, 10.0), between(rng, -3.0, 3.0));
            let is_apart = |q: &Vector3<f64>| (p - q).xy().norm() > 3.0;
            if places.iter().all(is_apart) {
                places.push(p);
            }
        }
        let mut headings: Vec<f64> = (0..vehicles).map(|_| between(rng, -PI, PI)).collect();
        headings[0] = 0.0;
        Self { places, headings }
    }

    fn offset(&self, from: usize, to: usize) -> Vector3<f64> {
        Rotation3::from_axis_angle(&Vector3::z_axis(), -self.headings[from])
            * (self.places[to] - self.places[from])
    }

    fn covariance(&self, from: usize, to: usize) -> Matrix3<f64> {
        let offset = self.offset(from, to);
        let (d2, along) = (offset.norm_squared(), offset * offset.transpose());
        Matrix3::identity() * (d2 * ACROSS * ACROSS) + along * (ALONG * ALONG - ACROSS * ACROSS)
    }

    /// What everybody sees, in an order of its own where nobody is named.
    fn reports(&self, rng: &mut Pcg64Mcg, named: bool) -> (Vec<Report>, Vec<Vec<usize>>) {
        let n = self.places.len();
        let mut orders = Vec::new();
        let mut reports = Vec::new();
        for from in 0..n {
            let mut order: Vec<usize> = (0..n).filter(|to| *to != from).collect();
            if !named {
                (1..order.len()).for_each(|k| order.swap(k, (uniform(rng) * (k + 1) as f64) as usize));
            }
            let sights = order.iter().map(|to| {
                let covariance = self.covariance(from, *to);
                let noise = Vector3::from_fn(|_, _| StandardNormal.sample(rng));
                let mean = self.offset(from, *to) + covariance.cholesky().unwrap().l() * noise;
                Sight { identity: named.then_some(*to as u32), position_m: Normal { mean, covariance } }
            });
            reports.push(Report { from: from as u32, sights: sights.collect() });
            orders.push(order);
        }
        (reports, orders)
    }

    /// Cramer and Rao's bound: the covariance of places and headings of all but the first, by finite differences.
    fn bound(&self) -> DMatrix<f64> {
        let n = self.places.len();
        let size = 4 * (n - 1);
        let mut information = DMatrix::zeros(size, size);
        for (from, to) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))).filter(|(a, b)| a != b) {
            let mut jacobian = DMatrix::zeros(3, size);
            for k in 0..size {
                let moved = |step: f64| {
                    let mut other = Truth { places: self.places.clone(), headings: self.headings.clone() };
                    match k % 4 {
                        3 => other.headings[1 + k / 4] += step,
                        axis => other.places[1 + k / 4][axis] += step,
                    }
                    other.offset(from, to)
                };
                jacobian.set_column(k, &((moved(1e-5) - moved(-1e-5)) / 2e-5));
            }
            let weight = self.covariance(from, to).try_inverse().unwrap();
            information +=
                jacobian.transpose() * DMatrix::from_column_slice(3, 3, weight.as_slice()) * jacobian;
        }
        information.try_inverse().unwrap()
    }
}

fn wrapped(angle: f64) -> f64 {
    libm::atan2(libm::sin(angle), libm::cos(angle))
}

/// Heading to half a degree, positions within 1.2 of the bound, covariances that keep their word: for a pair and for groups.
#[test]
fn a_named_group_is_located_as_well_as_can_be() {
    for vehicles in [2, 3, 5, 10] {
        let mut rng = Pcg64Mcg::new(vehicles as u128 + 40);
        let runs = if vehicles < 10 { 600 } else { 150 };
        let (mut error2, mut bound2, mut heading2, mut nees, mut count) = (0.0_f64, 0.0, 0.0_f64, 0.0, 0.0);
        for _ in 0..runs {
            let truth = Truth::random(&mut rng, vehicles);
            let (reports, _) = truth.reports(&mut rng, true);
            let group = locate(&reports[0], &reports[1..]).unwrap();
            assert_eq!(group.placed.len(), vehicles - 1);
            let bound = truth.bound();
            for (k, placed) in group.placed.iter().enumerate() {
                let error = placed.position_m.mean - truth.places[k + 1];
                error2 += error.norm_squared();
                bound2 += (0..3).map(|axis| bound[(4 * k + axis, 4 * k + axis)]).sum::<f64>();
                nees += error.dot(&(placed.position_m.covariance.try_inverse().unwrap() * error));
                heading2 += wrapped(placed.heading.angle_rad - truth.headings[k + 1]).powi(2);
                count += 1.0;
            }
        }
        let (ratio, heading_deg, nees) =
            ((error2 / bound2).sqrt(), (heading2 / count).sqrt().to_degrees(), nees / count);
        println!(
            "{vehicles} vehicles: {:.3} m, {ratio:.3} of the bound, heading {heading_deg:.3} deg, NEES {nees:.2}",
            (error2 / count).sqrt()
        );
        assert!(
            ratio < 1.2 && heading_deg < 0.5 && (2.7..3.3).contains(&nees),
            "{vehicles}: {ratio} {heading_deg} {nees}"
        );
    }
}

/// How often to try: more by hand.
fn cases(ordinary: u32) -> u32 {
    std::env::var("PHOTINUS_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(ordinary)
}

/// Nobody is named; each is told where it is, or that it is not clear.
#[test]
fn anonymous_groups_are_told_apart() {
    for vehicles in 2..=10 {
        let mut rng = Pcg64Mcg::new(vehicles as u128 + 900);
        let (mut right, mut unclear) = (0, 0);
        let runs = cases(15);
        for run in 0..runs {
            let truth = Truth::random(&mut rng, vehicles);
            let (reports, _) = truth.reports(&mut rng, false);
            match locate(&reports[0], &reports[1..]) {
                Ok(group) => {
                    assert_eq!(group.placed.len(), vehicles - 1, "run {run}");
                    for placed in &group.placed {
                        let error = placed.position_m.mean - truth.places[placed.identity as usize];
                        let off = error.dot(&(placed.position_m.covariance.try_inverse().unwrap() * error));
                        assert!(off < 40.0, "{vehicles} vehicles, run {run}: {off}");
                    }
                    right += 1;
                }
                Err(Unclear::Ambiguous { .. }) => unclear += 1,
                Err(other) => panic!("{vehicles} vehicles, run {run}: {other}"),
            }
        }
        println!("{vehicles} vehicles: {right} right, {unclear} unclear of {runs}");
        assert!(right * 10 >= runs * 9, "{vehicles}: {right}");
    }
}

/// Against every way to name all sights of three and four, each fitted as if it were known.
#[test]
fn brute_force_finds_the_same_way() {
    fn permutations(items: &[usize]) -> Vec<Vec<usize>> {
        if items.is_empty() {
            return vec![vec![]];
        }
        let with = |k: usize| {
            let mut rest = items.to_vec();
            let first = rest.remove(k);
            permutations(&rest).into_iter().map(move |mut p| {
                p.insert(0, first);
                p
            })
        };
        (0..items.len()).flat_map(with).collect()
    }
    let mut rng = Pcg64Mcg::new(4321);
    for (vehicles, runs) in [(3, 20), (4, 3)] {
        for _ in 0..runs {
            let truth = Truth::random(&mut rng, vehicles);
            let (reports, orders) = truth.reports(&mut rng, false);
            let each: Vec<Vec<Vec<usize>>> = orders.iter().map(|order| permutations(order)).collect();
            let (mut misfits, mut ways) = (Vec::new(), vec![0_usize; vehicles]);
            'all: loop {
                let named: Vec<Report> = reports
                    .iter()
                    .enumerate()
                    .map(|(k, report)| {
                        let name =
                            |(sight, id): (&Sight, &usize)| Sight { identity: Some(*id as u32), ..*sight };
                        Report {
                            from: report.from,
                            sights: report.sights.iter().zip(&each[k][ways[k]]).map(name).collect(),
                        }
                    })
                    .collect();
                if let Ok(group) = locate(&named[0], &named[1..]) {
                    misfits.push((
                        group.misfit,
                        ways.iter().zip(&each).map(|(w, all)| all[*w].clone()).collect::<Vec<_>>(),
                    ));
                }
                for k in 0..=vehicles {
                    if k == vehicles {
                        break 'all;
                    }
                    ways[k] += 1;
                    if ways[k] < each[k].len() {
                        break;
                    }
                    ways[k] = 0;
                }
            }
            misfits.sort_by(|a, b| a.0.total_cmp(&b.0));
            let is_unique = misfits[1].0 > misfits[0].0 + 30.0;
            match locate(&reports[0], &reports[1..]) {
                Ok(group) => {
                    assert!(is_unique && (group.misfit - misfits[0].0).abs() < 1e-3 * (1.0 + misfits[0].0));
                    assert_eq!(misfits[0].1, orders);
                }
                Err(Unclear::Ambiguous { .. }) => {
                    assert!(!is_unique, "{:?}", &misfits[..2].iter().map(|m| m.0).collect::<Vec<_>>());
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
}

/// Regular polygons look the same from every corner.
#[test]
fn symmetric_constellations_are_said_to_be_ambiguous() {
    for vehicles in 3..=7 {
        let mut rng = Pcg64Mcg::new(vehicles as u128);
        let corner = |k: usize| {
            let (sine, cosine) = libm::sincos(2.0 * PI * k as f64 / vehicles as f64);
            Vector3::new(8.0 * cosine, 8.0 * sine, 0.0)
        };
        let places: Vec<_> = (0..vehicles).map(|k| corner(k) - corner(0)).collect();
        let mut headings: Vec<f64> = (0..vehicles).map(|_| between(&mut rng, -PI, PI)).collect();
        headings[0] = 0.0;
        let truth = Truth { places, headings };
        let (reports, orders) = truth.reports(&mut rng, false);
        let told = locate(&reports[0], &reports[1..]);
        assert!(matches!(told, Err(Unclear::Ambiguous { ways }) if ways >= 2), "{vehicles}: {told:?}");
        // A triangle, one of whose sights is named, is clear.
        if vehicles == 3 {
            let mut named = reports.clone();
            named[0].sights[0].identity = Some(orders[0][0] as u32);
            assert!(locate(&named[0], &named[1..]).is_ok());
        }
    }
}

#[test]
fn a_heading_that_nothing_tells_is_not_told() {
    let report = |from: u32, to: u32, z: f64| Report {
        from,
        sights: vec![Sight {
            identity: Some(to),
            position_m: Normal { mean: Vector3::new(0.0, 0.0, z), covariance: Matrix3::identity() * 1e-3 },
        }],
    };
    let group = locate(&report(1, 2, 5.0), &[report(2, 1, -5.0)]);
    assert!(
        group.as_ref().map_or(true, |group| group.placed.is_empty() && group.undetermined == [2]),
        "{group:?}"
    );
    let nobody = Report { from: 2, sights: vec![] };
    assert_eq!(locate(&report(1, 3, 5.0), &[nobody]), Err(Unclear::NoConnection));
    assert_eq!(locate(&report(1, 2, 5.0), &[report(1, 2, 5.0)]), Err(Unclear::TwoReportsFrom(1)));
}

/// A compass drifts by tens of degrees; the bearing of a neighbour whose position is known does not.
#[test]
fn a_bearing_is_a_compass() {
    let mut rng = Pcg64Mcg::new(17);
    let (mut nees, mut error2, runs) = (0.0, 0.0, 4000);
    for _ in 0..runs {
        let truth = Truth::random(&mut rng, 2);
        let heading = between(&mut rng, -PI, PI);
        let rng = &mut rng;
        let mut normal =
            |sigma: f64| Vector3::from_fn(|_, _| sigma * Distribution::<f64>::sample(&StandardNormal, rng));
        // RTK: two centimetres.
        let rtk = Matrix3::identity() * 4e-4;
        let own = Normal { mean: normal(0.02), covariance: rtk };
        let other = Normal { mean: truth.places[1] + normal(0.02), covariance: rtk };
        let seen = Rotation3::from_axis_angle(&Vector3::z_axis(), -heading) * truth.places[1].normalize();
        let bearing = UnitVector3::new_normalize(seen + normal(0.002));
        let told = heading_from_bearing(&own, &other, &bearing, 0.002).unwrap();
        let error = wrapped(told.angle_rad - heading);
        nees += (error / told.sigma_rad).powi(2) / f64::from(runs);
        error2 += error * error / f64::from(runs);
    }
    println!("heading from one bearing: {:.3} deg, NEES {nees:.3}", error2.sqrt().to_degrees());
    assert!((0.93..1.07).contains(&nees) && error2.sqrt().to_degrees() < 0.5, "{nees} {error2}");
    let above = UnitVector3::new_normalize(Vector3::new(1e-4, 0.0, 1.0));
    let at = |z: f64| Normal { mean: Vector3::new(0.0, 1e-3, z), covariance: Matrix3::identity() * 1e-4 };
    assert!(heading_from_bearing(&at(0.0), &at(9.0), &above, 0.01).is_none());
}
