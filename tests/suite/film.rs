//! The sums of a render: films, their light groups, and the order in which tiles get samples.

use std::borrow::Cow;

use glossmith::{
    job::{
        features::Features,
        film::{Extras, Film},
        tiles::{Order, Schedule, SliceLimits, TileGrid},
    },
    render::output::Layers,
};

/// Samples of a mean that is far larger than their spread.
fn values(count: u32) -> impl Iterator<Item = f64> {
    (0..u64::from(count)).map(|i| 1000.0 + (i * 7919 % 101) as f64 / 101.0)
}

fn variance(count: u32) -> f64 {
    let mean = values(count).sum::<f64>() / f64::from(count);
    values(count).map(|y| (y - mean).powi(2)).sum::<f64>() / f64::from(count - 1)
}

#[test]
fn small_spreads_of_large_values_are_kept_and_do_not_stall() {
    // As the engines add them: in passes of some thousand, rounded at the end of each.
    const SAMPLES: u32 = 4_000_000;
    let mut film = Film::new(1, 1);
    let mut all = values(SAMPLES).enumerate().peekable();
    while all.peek().is_some() {
        let mut halves = film.pixels[0];
        for (sample, y) in all.by_ref().take(5000) {
            halves[sample % 2].add([y; 3]);
        }
        film.pixels[0] = halves;
    }
    let found = film.sums(0).spread();
    near!(found / variance(SAMPLES), 1.0, 0.0001);
    for half in film.pixels[0] {
        assert_eq!(half.samples, f64::from(SAMPLES / 2));
        near!(half.spread() / variance(SAMPLES), 1.0, 0.0001);
    }
    let mut one_by_one = Film::new(1, 1);
    values(1000)
        .enumerate()
        .for_each(|(sample, y)| one_by_one.add(0, sample as u32, [y, y, y, 1.0]));
    let found = one_by_one.variance_of_mean_at(0) * 1000.0;
    near!(found / variance(1000), 1.0, 0.0001);
}

#[test]
fn parts_come_back_to_their_place() {
    let mut film = Film::keeping(
        21,
        83,
        Extras {
            coverage: true,
            guides: 2,
            light_groups: 2,
        },
    );
    for pixel in 0..film.pixel_count() {
        film.add(pixel, pixel as u32, [pixel as f64, 1.0, 2.0, 0.5]);
        film.guides[2 * pixel + 1].hits = pixel as f32;
        film.add_lights(pixel, 1, [[pixel as f64; 3], [0.5; 3]]);
    }
    for (tile, costs) in film.costs.iter_mut().enumerate() {
        costs.rays = tile as f64;
    }
    let mut copy = Film::keeping(21, 83, film.extras());
    // Two tiles at a time, as far as there are.
    for tile in 0..film.grid().tiles() {
        let origin = film.grid().origin(tile);
        let size = [(21 - origin[0]).min(16), film.grid().size(tile)[1]];
        copy.place(origin, &film.part(origin, size));
    }
    assert_eq!(copy, film);
    let layers = Layers::of(&film, Features::of(&film, 2.0));
    assert_eq!(Layers::taken(film, 2.0), layers);
}

#[test]
fn a_mix_weighs_each_group_in_both_halves() {
    let extras = Extras {
        light_groups: 2,
        ..Extras::default()
    };
    let mut film = Film::keeping(1, 1, extras);
    for (sample, [first, second]) in [[1.0, 2.0], [3.0, 5.0], [2.0, 0.5]].into_iter().enumerate() {
        film.add(0, sample as u32, [first + second, first + second, first + second, 1.0]);
        film.add_lights(0, sample % 2, [[first; 3], [second; 3]]);
    }
    assert!(matches!(film.mixed(&[[1.0; 3], [1.0; 3]]), Cow::Borrowed(_)));
    let mixed = film.mixed(&[[2.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
    let [even, odd] = mixed.pixels[0];
    assert_eq!([even.color, odd.color], [[6.0, 2.5, 5.5], [6.0, 5.0, 8.0]]);
    assert_eq!([even.samples, odd.samples], [2.0, 1.0]);
    assert_eq!(film.light_image(0).pixels, [[2.0, 2.0, 2.0, 1.0]]);
}

#[test]
fn tiles_cover_the_picture_once() {
    let grid = TileGrid { width: 21, height: 8 };
    assert_eq!((grid.columns(), grid.rows()), (3, 1));
    let mut pixels = vec![0; grid.tiles()];
    (0..21 * 8).for_each(|pixel| pixels[grid.of_pixel(pixel)] += 1);
    assert_eq!(pixels, [64, 64, 40]);
    assert_eq!((0..3).map(|tile| grid.pixels(tile)).collect::<Vec<_>>(), [64, 64, 40]);
    assert_eq!((grid.origin(2), grid.size(2)), ([16, 0], [5, 8]));
    assert_eq!(grid.around(0).collect::<Vec<_>>(), [0, 1]);
    let middle = TileGrid { width: 24, height: 24 }.around(4);
    assert_eq!(middle.collect::<Vec<_>>(), (0..9).collect::<Vec<_>>());
}

#[test]
fn every_tile_gets_what_it_lacks_and_nothing_twice() {
    let mut schedule = Schedule::new(20, 10, 0);
    let goals = [5, 0, 3, 5, 5, 1];
    schedule.set_goals(&goals);
    let mut had = [0_u32; 6];
    let mut completed = 0;
    // No more than two tiles at a time, so that passes are cut.
    let two = SliceLimits {
        pass_samples: [1, 2],
        tiles: [1, 2],
        order: Order::Rows,
    };
    loop {
        let works = schedule.slice(1e9, two);
        if works.is_empty() {
            break;
        }
        for work in &works {
            assert_eq!(work.first_sample, had[work.tile]);
            had[work.tile] += work.count;
        }
        let is_end = schedule.finish(&works);
        completed = schedule.samples_per_pixel();
        assert!(!is_end || completed % 2 == 0 || completed == 5, "{completed}");
    }
    assert_eq!((had, completed), (goals, 5));
    assert!(schedule.is_at_goal());
    assert_eq!(schedule.pixel_samples(), 64 * 5 + 32 * 3 + 16 * (5 + 5) + 8);
    // A tile that was left behind catches up.
    schedule.set_goals(&[5; 6]);
    assert!(!schedule.is_at_goal());
    let all = SliceLimits {
        pass_samples: [1, 8],
        tiles: [1, 9],
        order: Order::Rows,
    };
    let works = schedule.slice(1e9, all);
    let counts: Vec<_> = works
        .iter()
        .map(|work| (work.tile, work.first_sample, work.count))
        .collect();
    assert_eq!(counts, [(1, 0, 5), (2, 3, 2), (5, 1, 4)]);
    schedule.finish(&works);
    assert_eq!(schedule.pixel_samples(), 20 * 10 * 5);
}
