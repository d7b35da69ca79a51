//! The colours of bodies that shine because they are hot.

/// Temperatures whose colours have no negative part in Rec. 709, kelvin, as far as lamps and skies have them.
pub const TEMPERATURES_K: [f64; 2] = [2000.0, 20000.0];

/// Linear Rec. 709 of a black body at so many kelvin, its largest part 1.
///
/// Source: Planck's law, seen by the CIE 1931 observer in the fit of Wyman, Sloan and Shirley,
/// JCGT 2(2), 2013.
pub fn blackbody_color(temperature_k: f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for nanometres in (360..=830).step_by(5) {
        let radiance = planck(f64::from(nanometres), temperature_k);
        for (sum, weight) in xyz.iter_mut().zip(observer(f64::from(nanometres))) {
            *sum += radiance * weight;
        }
    }
    let rgb = RGB_FROM_XYZ.map(|row| row.iter().zip(&xyz).map(|(a, b)| a * b).sum::<f64>());
    let largest = rgb.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    rgb.map(|x| (x / largest).max(0.0))
}

/// The temperature of the black body whose red and blue are in the same ratio, in [`TEMPERATURES_K`].
pub fn temperature_of_color([red, _, blue]: [f64; 3]) -> f64 {
    // Hotter ones are bluer.
    let is_redder = |temperature_k: f64| {
        let [of_red, _, of_blue] = blackbody_color(temperature_k);
        of_red * blue >= red * of_blue
    };
    let [mut low, mut high] = TEMPERATURES_K;
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        *(if is_redder(middle) { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

/// Proportional to the radiance a wavelength.
fn planck(nanometres: f64, temperature_k: f64) -> f64 {
    /// Second radiation constant, nm K.
    const C2: f64 = 1.438_776_877e7;
    (nanometres / 560.0).powi(-5) / (C2 / (nanometres * temperature_k)).exp_m1()
}

/// x̄, ȳ, z̄.
fn observer(nanometres: f64) -> [f64; 3] {
    let lobe = |height: f64, middle: f64, [below, above]: [f64; 2]| {
        let slope = if nanometres < middle { below } else { above };
        height * (-0.5 * ((nanometres - middle) * slope).powi(2)).exp()
    };
    [
        lobe(0.362, 442.0, [0.0624, 0.0374]) + lobe(1.056, 599.8, [0.0264, 0.0323])
            - lobe(0.065, 501.1, [0.0490, 0.0382]),
        lobe(0.821, 568.8, [0.0213, 0.0247]) + lobe(0.286, 530.9, [0.0613, 0.0322]),
        lobe(1.217, 437.0, [0.0845, 0.0278]) + lobe(0.681, 459.0, [0.0385, 0.0725]),
    ]
}

/// IEC 61966-2-1.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.2406, -1.5372, -0.4986],
    [-0.9689, 1.8758, 0.0415],
    [0.0557, -0.2040, 1.0570],
];
