"""What the compiled macro loops are made of.

`tables` says why they walk over raw memory; `record` has the rows, `packets` what is sent to FMUs,
`refresh` the end of a row, `leads` and `tangents` the ways of inputs, `ends` where these led them,
`quasi_newton` the solver of repeated steps, `crew` the threads. The loops are `held`, `explicit`
and `repeated`.
"""
