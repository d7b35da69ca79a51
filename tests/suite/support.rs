//! What several tests need.

use fearless_simd::Level;
use glam::Vec3;
use glossmith::instructions::Instructions;

/// Repeatable random numbers (SplitMix64: Steele, Lea and Flood 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In 0 … `count` − 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// In the unit ball.
    pub fn in_ball(&mut self) -> Vec3 {
        loop {
            let place = Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0;
            if place.length_squared() <= 1.0 {
                return place;
            }
        }
    }
}

/// The instruction sets of this processor, with their names.
pub fn sets() -> Vec<(&'static str, Level)> {
    let sets = Instructions::ALL.iter().filter(|set| **set != Instructions::Auto);
    sets.filter_map(|set| Some((set.name(), set.level()?))).collect()
}
