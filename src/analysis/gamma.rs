//! The incomplete gamma function, for tails of χ².

/// Terms beyond which a sum or a fraction ends: some ten times the root of the largest parameter that is asked for.
const TERMS: usize = 100_000;

/// Regularised upper incomplete gamma function Q(a, x): the share of Γ(a) = ∫ t^(a−1) e^−t dt from 0 to ∞ above x; a > 0, x
/// ≥ 0.
pub fn upper_share(a: f64, x: f64) -> f64 {
    let factor = (a * x.ln() - x - ln_gamma(a)).exp();
    if factor == 0.0 {
        return if x < a { 1.0 } else { 0.0 };
    }
    if x < a + 1.0 {
        1.0 - factor * lower_sum(a, x)
    } else {
        factor * upper_fraction(a, x)
    }
}

/// Σ xⁿ / (a (a+1) … (a+n)), which converges fast below a.
fn lower_sum(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for n in 1..TERMS {
        term *= x / (a + n as f64);
        sum += term;
        if term < sum * f64::EPSILON {
            break;
        }
    }
    sum
}

/// Legendre's continued fraction, which converges fast above a; from its head on (Lentz 1976).
fn upper_fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1.0 / f64::MIN_POSITIVE, 1.0 / b);
    let mut value = d;
    for n in 1..TERMS {
        let n = n as f64;
        let numerator = n * (a - n);
        b += 2.0;
        d = 1.0 / kept_from_0(b + numerator * d);
        c = kept_from_0(b + numerator / c);
        value *= c * d;
        if (c * d - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    value
}

fn kept_from_0(x: f64) -> f64 {
    if x.abs() < f64::MIN_POSITIVE {
        f64::MIN_POSITIVE
    } else {
        x
    }
}

/// ln Γ(a) for a > 0: Stirling's series, beyond a number from which on it is exact.
fn ln_gamma(a: f64) -> f64 {
    const EXACT_FROM: f64 = 12.0;
    let (mut at, mut below) = (a, 1.0);
    while at < EXACT_FROM {
        below *= at;
        at += 1.0;
    }
    let inverse = 1.0 / (at * at);
    let series = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1260.0,
        -1.0 / 1680.0,
        1.0 / 1188.0,
        -691.0 / 360_360.0,
    ];
    let series = series.iter().rev().fold(0.0, |sum, term| sum * inverse + term) / at;
    (at - 0.5) * at.ln() - at + 0.5 * std::f64::consts::TAU.ln() + series - below.ln()
}
