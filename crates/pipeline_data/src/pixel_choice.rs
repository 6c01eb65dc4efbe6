use bevy_ecs::resource::Resource;
use film::{FilmWindow, PixelBlock};
use glam::UVec2;
use radiometry::{SampleStream, StageKey};

/// Key of the random numbers of the choice.
const CHOICE_STAGE: StageKey = StageKey::new("pixel_choice");

/// Which part of the pixels to render: square blocks, chosen evenly at random.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelChoice {
    /// Side of a block in pixels, at least 1.
    pub side: u32,
    /// Blocks at most; all that there are when they are fewer.
    pub count: u32,
    /// Another seed chooses other blocks. Not that of the render, so that renders of several seeds share the blocks.
    pub seed: u64,
}

/// The blocks that were chosen, in rows from the top; their pixels are those of the film, in the same order. Written by
/// `image`, where the request has a [`PixelChoice`].
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct ChosenBlocks(pub Vec<PixelBlock>);

impl PixelChoice {
    /// Chooses blocks of a window. Those at the right and bottom edges are cut off.
    ///
    /// Every set of `count` blocks is as likely as any other.
    #[must_use]
    pub fn blocks(&self, window: &FilmWindow) -> Vec<PixelBlock> {
        let side = self.side.max(1);
        let cells = UVec2::new(window.size().x.div_ceil(side), window.size().y.div_ceil(side));
        let all = u64::from(cells.x) * u64::from(cells.y);
        let mut storage = 0;
        let mut blocks = Vec::new();
        // Knuth's algorithm S: each cell in turn, by the chance that the rest of the choice leaves it.
        let mut wanted = u64::from(self.count).min(all);
        for cell in 0..all {
            let u = SampleStream::new(self.seed, CHOICE_STAGE, cell, 0).draw_1d(0, 0);
            if f64::from(u) * (all - cell) as f64 >= wanted as f64 {
                continue;
            }
            wanted -= 1;
            let place = UVec2::new((cell % u64::from(cells.x)) as u32, (cell / u64::from(cells.x)) as u32);
            let min = window.crop_min + place * side;
            let max = (min + side).min(window.crop_max);
            let size = max - min;
            let end = storage + size.x as usize * size.y as usize;
            blocks.push(PixelBlock {
                min,
                max,
                storage: storage..end,
            });
            storage = end;
        }
        blocks
    }
}

impl ChosenBlocks {
    /// All pixels, block after block, each in rows from the top.
    #[must_use]
    pub fn pixels(&self) -> Vec<UVec2> {
        let rows = self.0.iter().flat_map(|block| {
            let (min, max) = (block.min, block.max);
            (min.y..max.y).flat_map(move |y| (min.x..max.x).map(move |x| UVec2::new(x, y)))
        });
        rows.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window() -> FilmWindow {
        FilmWindow {
            resolution: UVec2::new(100, 60),
            crop_min: UVec2::new(3, 5),
            crop_max: UVec2::new(100, 58),
        }
    }

    #[test]
    fn blocks_are_as_many_as_asked_for_and_apart() {
        for (count, expected) in [(0, 0), (1, 1), (20, 20), (1000, 13 * 7)] {
            let choice = PixelChoice {
                side: 8,
                count,
                seed: 1,
            };
            let chosen = ChosenBlocks(choice.blocks(&window()));
            assert_eq!(chosen.0.len(), expected);
            let pixels = chosen.pixels();
            assert_eq!(chosen.0.last().map_or(0, |block| block.storage.end), pixels.len());
            let mut sorted: Vec<_> = pixels.iter().map(|p| (p.y, p.x)).collect();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), pixels.len(), "no pixel twice");
            if count == 1000 {
                assert_eq!(pixels.len(), window().pixel_count());
            }
        }
    }

    #[test]
    fn every_block_has_the_same_chance() {
        let mut times = [0; 13 * 7];
        for seed in 0..400 {
            let choice = PixelChoice {
                side: 8,
                count: 20,
                seed,
            };
            for block in choice.blocks(&window()) {
                let place = (block.min - window().crop_min) / 8;
                times[(place.y * 13 + place.x) as usize] += 1;
            }
        }
        // 88 times each on average, with a standard deviation of 8.
        assert!(times.iter().all(|times| (55..125).contains(times)), "{times:?}");
    }
}
