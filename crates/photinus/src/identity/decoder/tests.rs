//! Decoding against brute force over everything that may be.

use super::super::evidence::Evidence;
use super::super::word::word;
use super::super::{CodeBook, Level, Word};
use super::*;
use proptest::prelude::*;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64Mcg;

const FRAME_S: f64 = 1.0 / 60.0;
const EXPOSURE_S: f64 = 1e-3;

fn book() -> CodeBook {
    // 10 bits, 3 apart at any shift
    let words = ["1011101000", "1101011000", "1110111000", "1010100100"];
    CodeBook::new(words.map(word).to_vec()).unwrap()
}

fn decoder() -> Decoder {
    Decoder::new(&book(), Settings::default()).unwrap()
}

fn uniform(random: &mut Pcg64Mcg) -> f64 {
    StandardUniform.sample(random)
}

/// Frames of bits that are wrong with probability `error`.
fn hear(decoder: &Decoder, listener: &mut Listener, bits: impl Iterator<Item = bool>, error: f64) {
    hear_for(EXPOSURE_S, decoder, listener, bits, error);
}

fn hear_for(
    exposure_s: f64,
    decoder: &Decoder,
    listener: &mut Listener,
    bits: impl Iterator<Item = bool>,
    error: f64,
) {
    let from_s = listener.last_s().unwrap_or(0.0);
    for (frame, bit) in (1..).zip(bits) {
        let time_s = from_s + f64::from(frame) * FRAME_S;
        decoder.hear(listener, time_s, exposure_s, &Evidence::of_bit(bit, error)).unwrap();
    }
}

fn sent(word: Word, phase: usize, frames: usize) -> impl Iterator<Item = bool> {
    (0..frames).map(move |frame| word.bit(phase + frame))
}

#[test]
fn settings_without_meaning_are_refused() {
    let with = |change: fn(&mut Settings)| {
        let mut settings = Settings::default();
        change(&mut settings);
        Decoder::new(&book(), settings).err()
    };
    assert_eq!(with(|s| s.bit_rate_hz = 0.0), Some(DecoderError::BitRate));
    assert_eq!(with(|s| s.known = f64::NAN), Some(DecoderError::Probability("known")));
    assert_eq!(with(|s| s.unknown = 0.5), Some(DecoderError::Probability("unknown")));
    assert_eq!(with(|s| s.stray = 0.5), Some(DecoderError::Probability("stray")));
    assert_eq!(with(|_| ()), None);
}

#[test]
fn each_word_is_known_at_each_phase_and_so_is_the_phase() {
    let decoder = decoder();
    for (id, &word) in book().words().iter().enumerate() {
        for phase in 0..10 {
            let mut listener = decoder.listener();
            // of words of ten bits one in a thousand is the very same: it takes rounds until that is left out
            hear(&decoder, &mut listener, sent(word, phase, 40), 0.001);
            let identity = decoder.identity(&listener);
            assert_eq!(identity.who, Who::Word(id));
            assert!(identity.probability > 0.999, "{identity:?}");
            // exposures are short: the beginning lies anywhere in the bit
            let found = decoder.phase(&listener, id).unwrap();
            let off = (found.bits - (phase + 39) as f64 - 0.5).rem_euclid(10.0);
            assert!(off.min(10.0 - off) < 0.3 && found.sigma_bits < 0.5, "{phase}: {found:?}");
            let next_s = listener.last_s().unwrap() + FRAME_S;
            let lit = decoder.light_at(&listener, next_s, EXPOSURE_S).unwrap();
            assert!((lit - f64::from(u8::from(word.bit(phase + 40)))).abs() < 0.1, "{lit}");
        }
    }
}

#[test]
fn other_lights_are_told_apart() {
    let decoder = decoder();
    let other = word("0000110111");
    let pattern = |frame: usize| other.bit(frame);
    let mut random = Pcg64Mcg::new(7);
    let coin: Vec<bool> = (0..60).map(|_| uniform(&mut random) < 0.5).collect();
    // bits without a pattern look like some word of ten bits now and then
    let signals: [(Who, Vec<bool>, f64); 4] = [
        (Who::Steady, vec![true; 60], 0.99),
        (Who::Dark, vec![false; 60], 0.99),
        (Who::Unknown, (0..60).map(pattern).collect(), 0.99),
        (Who::Unknown, coin, 0.5),
    ];
    for (who, bits, least) in signals {
        let mut listener = decoder.listener();
        hear(&decoder, &mut listener, bits.into_iter(), 0.01);
        let identity = decoder.identity(&listener);
        assert_eq!(identity.who, who);
        assert!(identity.probability > least, "{who:?} {identity:?}");
    }
}

#[test]
fn what_is_contradicted_is_forgotten() {
    let decoder = decoder();
    let book = book();
    let mut listener = decoder.listener();
    hear(&decoder, &mut listener, sent(book.words()[0], 3, 600), 0.01);
    assert_eq!(listener.awake, [0], "the others sleep");
    hear(&decoder, &mut listener, sent(book.words()[2], 5, 35), 0.01);
    let identity = decoder.identity(&listener);
    assert_eq!(identity.who, Who::Word(2));
    assert!(identity.probability > 0.999, "{identity:?}");
}

/// The light of an LED is learnt while it blinks, where spots are seen or not.
#[test]
fn words_are_known_from_spots_whose_light_was_not_known() {
    use rand_distr::StandardNormal;
    let (decoder, book) = (decoder(), book());
    let mut random = Pcg64Mcg::new(11);
    let (full, sigma, limit) = (300.0, 20.0, 100.0);
    let mut listener = decoder.listener();
    let mut level = Level::of_first(240.0).unwrap();
    for frame in 0..120 {
        let time_s = f64::from(frame) * FRAME_S;
        let lit = share_lit(book.words()[3], f64::from(frame) + 4.3, EXPOSURE_S * 60.0);
        let normal: f64 = StandardNormal.sample(&mut random);
        let light = lit * full + sigma * normal;
        level.wait(FRAME_S);
        let evidence = if light < limit {
            Evidence::of_absence(limit, sigma, &level)
        } else {
            Evidence::of_light(light, sigma, &level)
        };
        if light >= limit {
            level.see(light, sigma, 1.0);
        }
        decoder.hear(&mut listener, time_s, EXPOSURE_S, &evidence).unwrap();
    }
    assert!((level.full() / full - 1.0).abs() < 0.1, "{level:?}");
    let probability = decoder.probability(&listener, Who::Word(3));
    assert!(probability > 0.999, "{probability}");
    assert_eq!((Level::of_first(0.0), Level::known(1.0, -0.1)), (None, None));
}

/// The light of a saturated spot is unsure by half of it and more: that is no doubt whether there was light.
#[test]
fn words_are_known_from_spots_whose_light_is_unsure() {
    use rand_distr::StandardNormal;
    let (decoder, book) = (decoder(), book());
    let mut random = Pcg64Mcg::new(12);
    let (full, sigma_log, limit) = (1600.0, 0.63, 100.0);
    let mut listener = decoder.listener();
    let mut level = Level::of_first(full).unwrap();
    for frame in 0..40 {
        let time_s = f64::from(frame) * FRAME_S;
        let lit = share_lit(book.words()[3], f64::from(frame) + 4.3, EXPOSURE_S * 60.0);
        let normal: f64 = StandardNormal.sample(&mut random);
        let light = lit * full * libm::exp(0.3 * normal);
        level.wait(FRAME_S);
        let evidence = if light < limit {
            Evidence::of_absence(limit, 10.0, &level)
        } else {
            Evidence::of_light(light, sigma_log * light, &level)
        };
        decoder.hear(&mut listener, time_s, EXPOSURE_S, &evidence).unwrap();
        if light >= limit {
            level.see(light, sigma_log * light, 1.0);
            assert!(lit < 1.0 || evidence.off() < 0.05 * evidence.on(), "{evidence:?} {level:?} {light}");
        }
    }
    let probability = decoder.probability(&listener, Who::Word(3));
    assert!(probability > 0.99, "{probability} {:?}", decoder.identity(&listener));
}

#[test]
fn times_that_stand_change_nothing() {
    let decoder = decoder();
    let mut listener = decoder.listener();
    hear(&decoder, &mut listener, sent(book().words()[0], 0, 15), 0.01);
    let before = listener.clone();
    let last_s = listener.last_s().unwrap();
    for time_s in [last_s, last_s - 1.0, f64::NAN, f64::INFINITY] {
        let heard = decoder.hear(&mut listener, time_s, EXPOSURE_S, &Evidence::of_bit(true, 0.1));
        assert_eq!(heard, Err(TimeStands));
        assert_eq!(listener, before);
    }
    decoder.restart(&mut listener);
    assert_eq!(listener, decoder.listener());
}

/// The clock of an LED that is fast or slow passes over its frames' edges; frames are lost; nothing is.
#[test]
fn clocks_off_by_a_few_thousandths_are_followed() {
    let decoder = decoder();
    for (rate_hz, lost) in [(59.9, 0.0), (59.99, 0.3), (60.1, 0.0), (60.2, 0.3)] {
        let mut random = Pcg64Mcg::new(3);
        let mut listener = decoder.listener();
        let word = book().words()[1];
        let mut least = 1.0_f64;
        for frame in 0..6000 {
            let time_s = f64::from(frame) * FRAME_S;
            if uniform(&mut random) < lost {
                continue;
            }
            let lit = share_lit(word, time_s * rate_hz, EXPOSURE_S * rate_hz);
            let bit = uniform(&mut random) < 0.01 + 0.98 * lit;
            decoder.hear(&mut listener, time_s, EXPOSURE_S, &Evidence::of_bit(bit, 0.01)).unwrap();
            if frame > 60 {
                least = least.min(decoder.probability(&listener, Who::Word(1)));
            }
        }
        assert!(least > 0.9, "{rate_hz} Hz: {least}");
    }
}

/// The share of an exposure, in bits, that a word shines.
fn share_lit(word: Word, begin: f64, exposure: f64) -> f64 {
    let steps = 50;
    let lit = |step: i32| {
        let at = begin + exposure * (f64::from(step) + 0.5) / f64::from(steps);
        word.bit(at.rem_euclid(word.length() as f64) as usize)
    };
    f64::from((0..steps).map(|step| i32::from(lit(step))).sum::<i32>()) / f64::from(steps)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// While nothing strays or changes, the posterior is that of adding up every word at every phase.
    #[test]
    fn the_posterior_is_that_of_brute_force(seed in any::<u64>(), frames in 1..25_usize, error in 0.05..0.4_f64) {
        let settings = Settings { change: 1e-12, stray: 1e-9, unknown: 1e-9, ..Settings::default() };
        let decoder = Decoder::new(&book(), settings).unwrap();
        let mut random = Pcg64Mcg::new(seed.into());
        let bits: Vec<bool> = (0..frames).map(|_| uniform(&mut random) < 0.5).collect();
        let mut listener = decoder.listener();
        // an exposure of no length falls on one bit
        hear_for(0.0, &decoder, &mut listener, bits.iter().copied(), error);
        let weigh = |word: &Word, heard: &[bool]| -> f64 {
            let at = |phase: usize| {
                let of = |(frame, &bit): (usize, &bool)| if word.bit(phase + frame) == bit { 1.0 - error } else { error };
                heard.iter().enumerate().map(of).product::<f64>()
            };
            (0..10).map(at).sum::<f64>() / 10.0
        };
        // What was less likely than a millionth at some time sleeps, and where nothing unknown is believed in, nothing wakes it.
        let (known, steady) = (settings.known / 4.0, settings.steady);
        let shares = |heard: &[bool]| -> Vec<f64> {
            let all_are = |lit: bool| heard.iter().map(|&bit| if bit == lit { 1.0 - error } else { error }).product::<f64>();
            let words: Vec<f64> = book().words().iter().map(|word| known * weigh(word, heard)).collect();
            let dark = 1.0 - settings.known - steady;
            let total = words.iter().sum::<f64>() + steady * all_are(true) + dark * all_are(false);
            words.iter().map(|word| word / total).collect()
        };
        let expected = shares(&bits);
        let is_awake = |word: usize| (1..frames).all(|heard| shares(&bits[..heard])[word] > 1e-5);
        prop_assume!((0..4).all(|word| expected[word] < 1e-5 || is_awake(word)));
        let found: Vec<f64> = (0..4).map(|word| decoder.probability(&listener, Who::Word(word))).collect();
        let (sum, all): (f64, f64) = (expected.iter().sum(), found.iter().sum());
        for (expected, found) in expected.iter().zip(&found) {
            let off = (expected / sum * all - found).abs();
            prop_assert!(off < 0.01 * all + 1e-4, "{expected} {found}");
        }
        let others = [Who::Unknown, Who::Steady, Who::Dark].map(|who| decoder.probability(&listener, who));
        prop_assert!((all + others.iter().sum::<f64>() - 1.0).abs() < 1e-6);
    }

    /// Whatever is heard, probabilities are such.
    #[test]
    fn any_evidence_leaves_probabilities(
        frames in proptest::collection::vec((1e-4..3.0_f64, any::<u8>(), proptest::array::uniform5(-1e3..10.0_f64)), 1..60),
        exposure_s in 0.0..0.1_f64,
    ) {
        let decoder = decoder();
        let mut listener = decoder.listener();
        let mut time_s = -50.0;
        for (passed_s, kind, logs) in frames {
            time_s += passed_s;
            let level = Level::known(100.0, 0.1).unwrap();
            let evidence = match kind % 4 {
                0 => Evidence::of_log_likelihoods(logs).unwrap(),
                1 => Evidence::of_light(logs[0].exp2(), 5.0, &level),
                2 => Evidence::of_absence(30.0, 5.0, &level),
                _ => Evidence::NONE,
            };
            decoder.hear(&mut listener, time_s, exposure_s, &evidence).unwrap();
            let words: f64 = (0..4).map(|word| decoder.probability(&listener, Who::Word(word))).sum();
            let others = [Who::Unknown, Who::Steady, Who::Dark].map(|who| decoder.probability(&listener, who));
            prop_assert!((words + others.iter().sum::<f64>() - 1.0).abs() < 1e-6);
            prop_assert!(others.iter().all(|p| (0.0..=1.0).contains(p)), "{others:?}");
            let lit = decoder.light_at(&listener, time_s + 0.01, exposure_s).unwrap();
            prop_assert!((-1e-6..=1.0 + 1e-6).contains(&lit), "{lit}");
            if let Some(phase) = decoder.phase(&listener, 1) {
                prop_assert!((0.0..10.0).contains(&phase.bits) && phase.sigma_bits > 0.0, "{phase:?}");
            }
        }
    }
}
