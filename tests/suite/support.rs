//! What several tests need.

use std::sync::{Mutex, MutexGuard, Once, PoisonError};

use glam::Vec3;

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

/// What tests let panic on purpose says so.
const ON_PURPOSE: &str = "on purpose";

/// Panics of the program's own threads, which no test sees otherwise.
static BROKEN: Mutex<Vec<String>> = Mutex::new(Vec::new());

pub fn broken() -> MutexGuard<'static, Vec<String>> {
    BROKEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes note of panics in threads that have a name of the program's: tests are named after their path.
pub fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            let thread = std::thread::current();
            let is_ours = thread.name().is_some_and(|name| name != "main" && !name.contains("::"));
            let text = panic.to_string();
            if is_ours && !text.contains(ON_PURPOSE) && !glossmith::panics::is_contained() {
                broken().push(format!("{}: {text}", thread.name().unwrap_or_default()));
            }
            usual(panic);
        }));
    });
}
