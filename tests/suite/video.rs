//! Videos are played back frame by frame.

use crate::cli_support::Workplace;
use std::path::Path;

use glossmith::store::video::Video;
use openh264::{decoder::Decoder, formats::YUVSource as _};
use shiguredo_mp4::{boxes::SampleEntry, demux::Input, demux::Mp4FileDemuxer};

const SIZE: [u32; 2] = [48, 33];

/// A frame of one colour with a bright square that moves.
fn frame(number: u32) -> Vec<u8> {
    let [width, height] = SIZE;
    let pixel = |index: u32| match (index % width / 8, index / width / 8) {
        (x, 1) if x == number => [250, 240, 230, 255],
        _ => [180, 60, 30, 255],
    };
    (0..width * height).flat_map(pixel).collect()
}

fn written(path: &Path, fps: f64) {
    let mut video = Video::begin(path, SIZE, fps).expect("a video");
    (0..4).for_each(|number| video.add(&frame(number)).expect("a frame"));
    video.finish().expect("written");
}

/// Mean difference of two images' channels.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    let of_bytes = a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b)));
    of_bytes.sum::<f64>() / a.len() as f64
}

#[test]
fn an_mp4_is_played_back_frame_by_frame() {
    let folder = Workplace::new();
    let path = folder.path("turn.mp4");
    written(&path, 25.0);
    let bytes = std::fs::read(&path).expect("the file");
    let mut demuxer = Mp4FileDemuxer::new();
    demuxer.handle_input(Input {
        position: 0,
        data: &bytes,
    });
    let seconds = demuxer.tracks().expect("tracks")[0].duration as f64 / 25e3;
    near!(seconds, 0.16, 1e-9);
    let mut decoder = Decoder::new().expect("a decoder");
    let mut number = 0;
    while let Some(sample) = demuxer.next_sample().expect("a sample") {
        let mut stream = Vec::new();
        let annex_b = |unit: &[u8], stream: &mut Vec<u8>| {
            stream.extend([0, 0, 0, 1]);
            stream.extend(unit);
        };
        if let Some(SampleEntry::Avc1(entry)) = sample.sample_entry {
            let sets = entry.avcc_box.sps_list.iter().chain(&entry.avcc_box.pps_list);
            sets.for_each(|set| annex_b(set, &mut stream));
        }
        let mut data = &bytes[sample.data_offset as usize..][..sample.data_size];
        while let Some((length, rest)) = data.split_first_chunk::<4>() {
            let (unit, rest) = rest.split_at(u32::from_be_bytes(*length) as usize);
            annex_b(unit, &mut stream);
            data = rest;
        }
        let picture = decoder.decode(&stream).expect("it decodes").expect("a picture");
        assert_eq!(picture.dimensions(), (48, 32), "the odd row is left out");
        let mut rgb = vec![0; 3 * 48 * 32];
        picture.write_rgb8(&mut rgb);
        let expected = frame(number);
        let expected: Vec<u8> = expected[..4 * 48 * 32]
            .chunks(4)
            .flat_map(|p| [p[0], p[1], p[2]])
            .collect();
        let error = difference(&rgb, &expected);
        assert!(error < 4.0, "frame {number} is off by {error} codes");
        number += 1;
    }
    assert_eq!(number, 4);
}
