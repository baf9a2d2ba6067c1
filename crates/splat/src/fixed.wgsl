// The arithmetic of the sum: the twin of ../fixed.rs. A wide integer is (lower 32 bits, upper 32 bits).

fn wide_product(a: u32, b: u32) -> vec2<u32> {
    let low = (a & 0xFFFFu) * (b & 0xFFFFu);
    let left = (a >> 16u) * (b & 0xFFFFu);
    let right = (a & 0xFFFFu) * (b >> 16u);
    let middle = (low >> 16u) + (left & 0xFFFFu) + (right & 0xFFFFu);
    let high = (a >> 16u) * (b >> 16u) + (left >> 16u) + (right >> 16u) + (middle >> 16u);
    return vec2<u32>((low & 0xFFFFu) | (middle << 16u), high);
}

fn wide_sum(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2<u32>(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn wide_negative(a: vec2<u32>) -> vec2<u32> {
    return wide_sum(~a, vec2<u32>(1u, 0u));
}

// For shifts ≤ 63.
fn wide_right(a: vec2<u32>, shift: u32) -> vec2<u32> {
    if shift == 0u {
        return a;
    }
    if shift < 32u {
        return vec2<u32>((a.x >> shift) | (a.y << (32u - shift)), a.y >> shift);
    }
    return vec2<u32>(a.y >> (shift - 32u), 0u);
}

// A wide integer times one of 32 bits, its lower 64.
fn wide_times(a: vec2<u32>, b: u32) -> vec2<u32> {
    let low = wide_product(a.x, b);
    return vec2<u32>(low.x, low.y + a.y * b);
}

fn mul_shift(a: u32, b: u32, shift: u32) -> u32 {
    return wide_right(wide_product(a, b), shift).x;
}

fn signed_mul_shift(a: i32, b: i32, shift: u32) -> i32 {
    let size = i32(mul_shift(u32(abs(a)), u32(abs(b)), shift));
    return select(size, -size, (a ^ b) < 0);
}

fn integer_sqrt(x: u32) -> u32 {
    // The square root of a float may be off by a few of its last bits.
    var root = min(u32(sqrt(f32(x))), 65535u);
    while root * root > x {
        root -= 1u;
    }
    while root < 65535u && (root + 1u) * (root + 1u) <= x {
        root += 1u;
    }
    return root;
}

fn hypotenuse(a: u32, b: u32, less: u32) -> u32 {
    let zeros = min(countLeadingZeros(a | b), 17u);
    let shift = 17u - zeros;
    let x = a >> shift;
    let y = b >> shift;
    let square = x * x + y * y;
    return integer_sqrt(square - min(square, less >> (2u * shift))) << shift;
}

fn ratio(numerator: u32, divisor: u32, most: u32) -> u32 {
    let denominator = max(divisor, 1u);
    var quotient = numerator / denominator;
    if quotient >= most {
        return most << 24u;
    }
    var rest = numerator % denominator;
    for (var k = 0u; k < 4u; k += 1u) {
        rest <<= 6u;
        quotient = (quotient << 6u) | (rest / denominator);
        rest %= denominator;
    }
    return quotient;
}

struct Reciprocal {
    value: u32,
    bits: u32,
}

fn reciprocal_of(number: u32) -> Reciprocal {
    let size = 31u - countLeadingZeros(number);
    let bits = min(size, 30u - size);
    let whole = (1u << 31u) / number;
    let rest = (1u << 31u) % number;
    return Reciprocal((whole << bits) + (rest << bits) / number, bits);
}

struct Divisor {
    shift: u32,
    reciprocal: u32,
}

fn divisor_of(divisor: u32) -> Divisor {
    let shift = 16u - min(countLeadingZeros(divisor), 16u);
    return Divisor(shift, (1u << 31u) / (divisor >> shift));
}

fn divide(by: Divisor, x: i32) -> i32 {
    let size = i32(min(mul_shift(u32(abs(x)) >> by.shift, by.reciprocal, 17u), 1u << 15u));
    return select(size, -size, x < 0);
}

// The nearest float, ties to even.
fn float_of(x: u32) -> f32 {
    if x < 0x1000000u {
        return f32(x);
    }
    let shift = 8u - countLeadingZeros(x);
    let rest = x & ((1u << shift) - 1u);
    let middle = 1u << (shift - 1u);
    var top = x >> shift;
    if rest > middle || (rest == middle && (top & 1u) == 1u) {
        top += 1u;
    }
    return f32(top) * f32(1u << shift);
}
