"""Pictures of an answer as inline SVG: places in percent, so that a text keeps its size at each
width.

Keys of `Answer.picture`, which may hold `left_out` (rows that are not drawn) and `caption` (what is
drawn, in words):

`goals`, `front`, `named`, `words`, `units`: values of the goals of the designs of a search (n, k),
which of them no other one beats (n,), those of the headline in the order of the first rows of the
table, words and units of the goals; of one goal `history`: the best value so far (n,).

`values`: values of the conditions of each row of the table (list of arrays), the worst value where
one is not held.

`base`, `points`: the contact model that others are compared with, and for each other one its
results `y` and those of the base `x` on like rows.

`pairs`, `titles`: shares of the variance that pairs of factors hold, (k, k) [1], with the names of
the factors.

Without `goals`, `values` and `points` the effect curves are the picture of the first screen.
"""
