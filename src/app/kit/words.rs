//! Numbers in words.

/// A time in words, two digits.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.0995 => format!("{:.0} ms", 1e3 * s),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.0} days", s / 86_400.0),
    }
}

/// A time from which what is left of a work is known, seconds.
const FORECAST_FROM_S: f64 = 0.5;
/// A share from which what is left of a work is known.
const FORECAST_FROM_SHARE: f64 = 0.01;

/// What is left of a work of which a share is done after a time: "40 s left". `None` where that would be a guess.
pub fn time_left(share: f64, seconds: f64) -> Option<String> {
    let is_told = seconds >= FORECAST_FROM_S && (FORECAST_FROM_SHARE..1.0).contains(&share);
    is_told.then(|| format!("{} left", about(seconds * (1.0 / share - 1.0))))
}

/// A time in steps so coarse that a text with it does not flicker.
pub fn about(seconds: f64) -> String {
    let step = match seconds {
        s if s < 10.0 => 1.0,
        s if s < 60.0 => 5.0,
        s if s < 100.0 => 10.0,
        _ => 60.0,
    };
    match ((seconds / step).round() * step).max(1.0) {
        s if s < 9.95 => format!("{s:.0} s"),
        s => duration(s),
    }
}

/// A share in per cent with as many digits as it has.
pub fn percent_short(share: f64) -> String {
    // Fifteen digits hide what the hundredfold adds to a decimal number.
    format!("{} %", (share * 1e10).round() / 1e8)
}

/// Values below this are not distinguished from 0, percent.
const PERCENT_MIN: f64 = 0.0001;

/// A share as a percentage with three digits.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    if value > 0.0 && value < PERCENT_MIN {
        return format!("< {PERCENT_MIN} %");
    }
    let decimals = match value {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        v if v >= 1.0 || v == 0.0 => 2,
        v if v >= 0.1 => 3,
        _ => 4,
    };
    format!("{value:.decimals$} %")
}

/// An error relative to the mean: above all of it the estimate is worth nothing yet.
pub fn error(share: f64) -> String {
    if share < 1.0 {
        percent(share)
    } else {
        "not yet known".to_owned()
    }
}

/// A number with three digits and a prefix.
pub fn short_number(value: f64) -> String {
    let (scaled, prefix) = match value {
        v if v >= 1e9 => (v / 1e9, " G"),
        v if v >= 1e6 => (v / 1e6, " M"),
        v if v >= 1e3 => (v / 1e3, " k"),
        v => (v, ""),
    };
    let decimals = match scaled {
        s if s >= 100.0 || prefix.is_empty() => 0,
        s if s >= 10.0 => 1,
        _ => 2,
    };
    format!("{scaled:.decimals$}{prefix}")
}
