# The fraction of a cell (src/servo/axis.rs): (x - start) * (1 / (end - start)), each operation rounded to
# f32, against the real quotient, for widths from 2^-20 m (below 1 µm) to 2 m. Nearer than 2^-100 m to the
# start, the two are below 2^-79 and differ by less. For x below the start both change sign.
# Proves: SRV-015. It is bound 1 of spec/servo.md.

@rounded = float<ieee_32, ne>;

start = rounded(start_);
end = rounded(end_);
x = rounded(x_);

width rounded= end - start;
reciprocal rounded= 1 / width;
distance rounded= x - start;
fraction rounded= distance * reciprocal;

exact = (x - start) * (1 / (end - start));

{
  |start| <= 1 /\ |end| <= 1 /\ end - start in [1b-20, 2] /\ x - start in [1b-100, 8] /\ exact in [0, 2]
  -> |fraction -/ exact| <= 0x4.1p-24
}
