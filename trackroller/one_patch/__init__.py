"""One contact by itself: given load, shape, materials, friction and creepages, without a roller around it."""
