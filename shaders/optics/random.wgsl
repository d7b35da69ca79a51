// Counter-based random numbers. Twin of src/optics/random.rs, equal to the bit.
#import "optics/choices"

struct RandomState {
    key: u32,
    sample: u32,
    sequence: u32,
}

fn random_state(x: u32, y: u32, seed: u32, sample: u32, sequence: u32) -> RandomState {
    return RandomState(hash_bits((x | (y << 16u)) ^ hash_bits(seed)), sample, sequence);
}

fn path_state(x: u32, y: u32, seed: u32, sample: u32, sequence: u32) -> RandomState {
    let state = random_state(x, y, seed, sample, sequence);
    if sequence == SEQUENCE_SOBOL {
        let key = select(hash_bits(state.key ^ 0x5851f42du), state.key, sample % 2u == 0u);
        return RandomState(key, sample / 2u, sequence);
    }
    return state;
}

fn hash_bits(bits: u32) -> u32 {
    var x = bits;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

fn unit_from_bits(bits: u32) -> f32 {
    return f32(bits >> 8u) * 5.9604644775390625e-8;
}

fn random_bits(key: u32, sample: u32, dimension: u32) -> u32 {
    let stream = hash_bits(key ^ (dimension * 0x9e3779b9u));
    return hash_bits(hash_bits(sample ^ stream) + (((stream << 16u) | (stream >> 16u)) ^ key));
}

fn scramble_from_low(bits: u32, seed: u32) -> u32 {
    var x = bits;
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

fn sobol_second_reversed(index: u32) -> u32 {
    var x = index;
    x ^= (x >> 1u) & 0x55555555u;
    x ^= (x >> 2u) & 0x33333333u;
    x ^= (x >> 4u) & 0x0f0f0f0fu;
    x ^= (x >> 8u) & 0x00ff00ffu;
    return x ^ ((x >> 16u) & 0x0000ffffu);
}

fn random_pair_bits(state: RandomState, dimension: u32) -> vec2u {
    if state.sequence == SEQUENCE_SOBOL {
        let seed = hash_bits(state.key ^ (dimension * 0x9e3779b9u + 0x2545f491u));
        let index = reverseBits(scramble_from_low(reverseBits(state.sample), seed));
        return vec2u(
            reverseBits(scramble_from_low(index, hash_bits(seed ^ 0x68bc21ebu))),
            reverseBits(scramble_from_low(sobol_second_reversed(index), hash_bits(seed ^ 0x02e5be93u))),
        );
    }
    return vec2u(
        random_bits(state.key, state.sample, 2u * dimension),
        random_bits(state.key, state.sample, 2u * dimension + 1u),
    );
}

fn random_pair(state: RandomState, dimension: u32) -> vec2f {
    let bits = random_pair_bits(state, dimension);
    return vec2f(unit_from_bits(bits.x), unit_from_bits(bits.y));
}
