"""Pictures of an answer as inline SVG: places in percent, so that a text keeps its size at each width.

Keys of `Answer.picture`, which may hold `left_out` (rows that are not drawn) and `caption` (what is drawn, in words):

`front`: dict `x`, `y` (dict `title`, `units`, `logarithmic`), `points` (n, 2), `best` (n,) whether a design belongs to
the front, `named` (list of dict `x`, `y`, `title`), `beyond` (part of the range of `x` without a design, or None).

`history`: dict `evaluations` (k,), `best` (k,) best value of the goal so far [unit of the output].

`values`: values of the conditions of each row of the table (list of arrays), the worst value where one is not held.

`base`, `points`: the contact model that others are compared with, and for each other one its results `y` and those of
the base `x` on like rows.

`pairs`, `titles`: shares of the variance that pairs of factors hold, (k, k) [1], with the names of the factors.

Without one of the first four, the effect curves are the picture of the first screen.
"""
