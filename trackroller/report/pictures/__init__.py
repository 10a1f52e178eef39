"""Pictures of an answer as inline SVG: places in percent, so that a text keeps its size at each width.

Keys of `Answer.picture`, one of these besides `pairs`; every picture may hold `left_out` (rows that are not drawn) and
`caption` (what is drawn, in words):

`front`: `x`, `y` (dict `title`, `units`, `logarithmic`), `points` (n, 2), `best` (n,) whether a design belongs to the
front, `named` (list of dict `x`, `y`, `title`), `beyond` (part of the range of `x` without a design, or None).

`history`: `evaluations` (k,), `best` (k,) best value of the goal so far [unit of the output].

`distribution`: `values` (dict: name of a candidate -> its values over the conditions (n,), 0 where it does not hold).

`like`: `base` (the model that others are compared with), `ratios` (dict: title -> ratios on like rows (n,)).

`slice`: `title`, `units`, `logarithmic`, `levels` (k,), `series` (dict: name -> values (k,)), `held` (the other
factors in words).

`pairs`: a list of dict `titles`, `units` (two each), `first` (k,), `second` (m,) levels, `middle` (k, m) of the output,
`index` (share of the variance [1], NaN if unknown).
"""
