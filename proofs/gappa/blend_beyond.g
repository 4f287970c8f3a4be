# (1 - t) a + t b (src/servo/table.rs) up to one cell beyond the border, each operation rounded to f32, against the real
# value at the real fraction, for forces up to 1.
# Proves: SRV-015. It is bound 3 of spec/servo.md.

@rounded = float<ieee_32, ne>;

a = rounded(a_);
b = rounded(b_);
t = rounded(t_);

rest rounded= 1 - t;
first rounded= rest * a;
second rounded= t * b;
value rounded= first + second;

exact = (1 - fraction) * a + fraction * b;
same_fraction = (1 - t) * a + t * b;

{
  |a| <= 1 /\ |b| <= 1 /\ t in [-1, 2] /\ |t - fraction| <= 0x8.2p-24
  -> |value - exact| <= 0x15.4p-24
}

value - exact -> (value - same_fraction) + (t - fraction) * (b - a);
