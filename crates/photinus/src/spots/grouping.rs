//! Runs -> components: runs that touch, also by a corner (8-connectivity).
//!
//! In: runs in raster order. Out: the same runs ordered by component, components in the order of their first pixel. One
//! pass with union-find: two runs of neighbouring rows touch when they overlap by a pixel more on either side.

use alloc::vec::Vec;
use core::ops::Range;

use super::runs::Run;

/// The components of one frame, and the room to find them in.
#[derive(Debug, Default)]
pub(super) struct Components {
    parent: Vec<u32>,
    component: Vec<u32>,
    starts: Vec<u32>,
    ordered: Vec<Run>,
}

impl Components {
    /// Groups `runs`, which are in raster order.
    pub(super) fn group(&mut self, runs: &[Run]) {
        self.parent.clear();
        self.parent.extend(0..runs.len() as u32);
        self.unite_touching(runs);
        self.order_by_component(runs);
    }

    /// How many components there are.
    pub(super) fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The runs of a component, in raster order.
    pub(super) fn runs(&self, component: usize) -> &[Run] {
        &self.ordered[self.range(component)]
    }

    fn range(&self, component: usize) -> Range<usize> {
        self.starts[component] as usize..self.starts[component + 1] as usize
    }

    fn unite_touching(&mut self, runs: &[Run]) {
        let mut above = 0;
        for (i, run) in runs.iter().enumerate() {
            while runs[above].v + 1 < run.v || (runs[above].v + 1 == run.v && runs[above].end < run.start) {
                above += 1;
            }
            let touching =
                runs[above..i].iter().take_while(|other| other.v < run.v && other.start <= run.end);
            for j in above..above + touching.count() {
                self.unite(j as u32, i as u32);
            }
        }
    }

    /// The earlier root wins, so that a component is named by its first run.
    fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    fn root(&mut self, mut run: u32) -> u32 {
        while self.parent[run as usize] != run {
            let grandparent = self.parent[self.parent[run as usize] as usize];
            self.parent[run as usize] = grandparent;
            run = grandparent;
        }
        run
    }

    /// Counting sort, stable: runs of a component keep their raster order.
    fn order_by_component(&mut self, runs: &[Run]) {
        self.component.clear();
        self.starts.clear();
        self.starts.push(0);
        for i in 0..runs.len() as u32 {
            let root = self.root(i);
            if root == i {
                self.component.push(self.starts.len() as u32 - 1);
                self.starts.push(0);
            } else {
                self.component.push(self.component[root as usize]);
            }
            self.starts[self.component[i as usize] as usize + 1] += 1;
        }
        for component in 1..self.starts.len() {
            self.starts[component] += self.starts[component - 1];
        }
        self.ordered.clear();
        self.ordered.resize(runs.len(), Run { v: 0, start: 0, end: 0 });
        for (run, &component) in runs.iter().zip(&self.component) {
            let place = &mut self.starts[component as usize];
            self.ordered[*place as usize] = *run;
            *place += 1;
        }
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameView;
    use crate::spots::background::Background;
    use crate::spots::runs::Runs;
    use crate::spots::settings::Brightness;
    use proptest::prelude::*;

    /// The obviously right version: flood fill over the eight neighbours.
    fn flood(bright: &[bool], width: usize) -> Vec<Vec<usize>> {
        let mut seen = vec![false; bright.len()];
        let mut components = Vec::new();
        for first in 0..bright.len() {
            if !bright[first] || seen[first] {
                continue;
            }
            let (mut open, mut found) = (vec![first], Vec::new());
            seen[first] = true;
            while let Some(at) = open.pop() {
                found.push(at);
                let (u, v) = ((at % width) as i32, (at / width) as i32);
                for (du, dv) in (-1..=1).flat_map(|dv| (-1..=1).map(move |du| (du, dv))) {
                    let (u, v) = (u + du, v + dv);
                    if u < 0 || v < 0 || u as usize >= width || v as usize >= bright.len() / width {
                        continue;
                    }
                    let next = v as usize * width + u as usize;
                    if bright[next] && !seen[next] {
                        seen[next] = true;
                        open.push(next);
                    }
                }
            }
            found.sort_unstable();
            components.push(found);
        }
        components
    }

    proptest! {
        #[test]
        fn components_are_those_of_a_flood_fill(
            width in 1usize..50, height in 1usize..50,
            pixels in prop::collection::vec(any::<u8>(), 50 * 50), threshold in 60u8..250,
        ) {
            let pixels = &pixels[..width * height];
            let frame = FrameView::packed(pixels, width, height).unwrap();
            let mut background = Background::default();
            background.measure(&frame, Brightness::Threshold(threshold));
            let mut components = Components::default();
            components.group(Runs::default().find(&frame, &background));
            let ours: Vec<Vec<usize>> = (0..components.len())
                .map(|c| {
                    let pixels = |run: &Run| {
                        let row = usize::from(run.v) * width;
                        row + usize::from(run.start)..row + usize::from(run.end)
                    };
                    components.runs(c).iter().flat_map(pixels).collect()
                })
                .collect();
            let bright: Vec<bool> = pixels.iter().map(|&p| p >= threshold).collect();
            prop_assert_eq!(ours, flood(&bright, width));
        }
    }
}
