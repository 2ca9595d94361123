"""How good an answer is: what is known before a run, what it shows, and what repeating it shows.

`self_test` finds out whether an FMU does what it says (on a `probe`, remembered by `tested`),
`step_limit` predicts the largest stable macro step, and `verdict` says in one sentence what these,
the energy residuals and a refinement (`whole.verify`) mean. All that is found is data, in
`findings`. See docs/trust.md.
"""
