//! Which of its turns that look the same a symmetric airframe is in, frame by frame: the powers of its LEDs tell. Within a track the
//! turn hardly ever changes; the likeliest sequence is found by dynamic programming (A. J. Viterbi, 1967).

use super::adjust::Adjustment;
use super::flight::{Flight, Frame};

/// What it costs that a track slips from one turn to another between two frames, nats.
const SLIP_NATS: f64 = 12.0;
/// A track whose sequence fits this much better than the same sequence one turn on, nats, is surely turned so.
const SURE_NATS: f64 = 6.0;
/// What a frame costs at most, nats: one that fits in no turn decides nothing.
const MOST_NATS: f64 = 20.0;

/// All frames of a flight in the turns that fit what is known so far, and how many are left out since nothing tells theirs.
pub(super) fn turned<'a>(flight: &'a Flight, so_far: Adjustment<'a>) -> (Adjustment<'a>, usize) {
    if flight.turns() == 1 {
        return (so_far, 0);
    }
    let (mut frames, mut unturned) = (Vec::new(), 0);
    for track in flight.tracks() {
        match likeliest(flight, track, &so_far) {
            Some(mut turned) => frames.append(&mut turned),
            None => unturned += track.len(),
        }
    }
    match frames.is_empty() {
        true => (so_far, unturned),
        false => (so_far.with_frames(frames), unturned),
    }
}

/// The frames of a track in their likeliest turns; `None` where another sequence is nearly as likely.
fn likeliest(flight: &Flight, track: &[Frame], so_far: &Adjustment<'_>) -> Option<Vec<Frame>> {
    let (turns, model) = (flight.turns(), so_far.model()?);
    let in_turn = |frame: &Frame, turn: usize| {
        let turned = flight.turned(frame, turn);
        so_far
            .posed(&model, &turned)
            .map_or((MOST_NATS, turned), |(nats, posed)| (nats.min(MOST_NATS), posed))
    };
    let costs: Vec<Vec<(f64, Frame)>> =
        track.iter().map(|frame| (0..turns).map(|turn| in_turn(frame, turn)).collect()).collect();
    let path = cheapest(&costs)?;
    let cost_of = |more: usize| -> f64 {
        path.iter().zip(&costs).map(|(turn, costs)| costs[(turn + more) % turns].0).sum()
    };
    let is_sure = (1..turns).all(|more| cost_of(more) > cost_of(0) + SURE_NATS);
    is_sure.then(|| path.iter().zip(&costs).map(|(turn, costs)| costs[*turn].1.clone()).collect())
}

/// The cheapest sequence of turns.
fn cheapest<T>(costs: &[Vec<(f64, T)>]) -> Option<Vec<usize>> {
    let mut totals: Vec<f64> = costs.first()?.iter().map(|cost| cost.0).collect();
    let mut came_from: Vec<Vec<usize>> = Vec::with_capacity(costs.len());
    let least = |totals: &[f64]| (0..totals.len()).min_by(|&a, &b| totals[a].total_cmp(&totals[b]));
    for frame in &costs[1..] {
        let slipped = least(&totals)?;
        let from = |turn: usize| if totals[turn] <= totals[slipped] + SLIP_NATS { turn } else { slipped };
        let before: Vec<usize> = (0..frame.len()).map(from).collect();
        let slip = |turn: usize| if before[turn] == turn { 0.0 } else { SLIP_NATS };
        totals = (0..frame.len()).map(|turn| totals[before[turn]] + slip(turn) + frame[turn].0).collect();
        came_from.push(before);
    }
    let mut turn = least(&totals)?;
    let mut path = vec![turn];
    for before in came_from.iter().rev() {
        turn = before[turn];
        path.push(turn);
    }
    path.reverse();
    Some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheapest_sequence_slips_only_where_that_pays() {
        let frame = |costs: [f64; 3]| costs.map(|cost| (cost, ())).to_vec();
        let steady = [frame([0.0, 5.0, 9.0]), frame([6.0, 0.0, 9.0]), frame([0.0, 5.0, 9.0])];
        assert_eq!(cheapest(&steady), Some(vec![0, 0, 0]));
        let slips: Vec<_> =
            (0..8).map(|at| frame(if at < 4 { [0.0, 5.0, 9.0] } else { [9.0, 9.0, 0.0] })).collect();
        assert_eq!(cheapest(&slips), Some(vec![0, 0, 0, 0, 2, 2, 2, 2]));
        // the same by trying all sequences
        let costs: Vec<Vec<(f64, ())>> = (0..6)
            .map(|at| frame([0, 1, 2].map(|turn| f64::from((at * 7 + turn * 11) % 13) * 1.7)))
            .collect();
        let cost = |path: &[usize]| {
            let slips = path.windows(2).filter(|pair| pair[0] != pair[1]).count() as f64 * SLIP_NATS;
            slips + path.iter().zip(&costs).map(|(turn, costs)| costs[*turn].0).sum::<f64>()
        };
        let path = |number: usize| (0..6).map(|at| number / 3_usize.pow(at) % 3).collect::<Vec<_>>();
        let best = (0..729).map(path).map(|path| cost(&path)).fold(f64::INFINITY, f64::min);
        assert!((cost(&cheapest(&costs).unwrap()) - best).abs() < 1e-9);
    }
}
