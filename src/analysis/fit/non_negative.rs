//! Non-negative least squares by active sets (Lawson and Hanson 1974), on the normal equations (Bro and De Jong 1997).

/// Gradient, relative to the largest product with the right side, from which a variable is freed.
const GAIN_MIN: f64 = 1e-13;
/// Times the number of variables: rounds after which the best that was found has to do.
const ROUNDS: usize = 10;

/// The x without negative components that minimises ½ xᵀ·gram·x − right·x; gram is symmetric and positive definite.
/// `None` where it is not, or a number is not finite.
pub fn non_negative(gram: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    if !gram.iter().flatten().chain(right).all(|x| x.is_finite()) {
        return None;
    }
    let count = right.len();
    let least = GAIN_MIN * right.iter().fold(0.0, |most, x| x.abs().max(most));
    let mut x = vec![0.0; count];
    let mut free: Vec<usize> = Vec::new();
    // Variables that only rounding made promising since the last real step.
    let mut refused: Vec<usize> = Vec::new();
    for _ in 0..ROUNDS * count {
        let gain = |i: usize| right[i] - gram[i].iter().zip(&x).map(|(g, x)| g * x).sum::<f64>();
        let fixed = (0..count).filter(|i| !free.contains(i) && !refused.contains(i));
        let best = fixed.map(|i| (i, gain(i))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((entering, _)) = best.filter(|(_, gain)| *gain > least) else {
            break;
        };
        free.push(entering);
        loop {
            let wanted = minimum(gram, right, &free)?;
            if step(&mut x, &mut free, &wanted) {
                break;
            }
        }
        if free.contains(&entering) {
            refused.clear();
        } else {
            refused.push(entering);
        }
    }
    Some(x)
}

/// Steps from x towards `wanted` in the free variables, as far as none becomes negative. Those that reach 0 are fixed there.
/// Returns true if it went all the way.
fn step(x: &mut [f64], free: &mut Vec<usize>, wanted: &[f64]) -> bool {
    let reach =
        |(&i, &wanted): (&usize, &f64)| (wanted <= 0.0).then(|| (i, x[i] / (x[i] - wanted).max(f64::MIN_POSITIVE)));
    let nearest = free
        .iter()
        .zip(wanted)
        .filter_map(reach)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let share = nearest.map_or(1.0, |(_, share)| share);
    for (&i, wanted) in free.iter().zip(wanted) {
        x[i] += share * (wanted - x[i]);
    }
    let Some((stopped, _)) = nearest else {
        return true;
    };
    x[stopped] = 0.0;
    free.retain(|&i| x[i] > 0.0);
    (0..x.len()).filter(|i| !free.contains(i)).for_each(|i| x[i] = 0.0);
    false
}

/// The minimum over the free variables with the others at 0, by Cholesky factorisation.
fn minimum(gram: &[Vec<f64>], right: &[f64], free: &[usize]) -> Option<Vec<f64>> {
    let count = free.len();
    let mut lower = vec![vec![0.0; count]; count];
    let mut solution: Vec<f64> = free.iter().map(|&i| right[i]).collect();
    for i in 0..count {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = gram[free[i]][free[j]] - known;
            lower[i][j] = if i == j { rest.sqrt() } else { rest / lower[j][j] };
        }
        let known: f64 = (0..i).map(|k| lower[i][k] * solution[k]).sum();
        solution[i] = (solution[i] - known) / lower[i][i];
    }
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|k| lower[k][i] * solution[k]).sum();
        solution[i] = (solution[i] - known) / lower[i][i];
    }
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}
