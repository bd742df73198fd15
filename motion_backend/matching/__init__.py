"""Motion matching (Büttner and Clavet 2015): walks put together from recorded frames that fit the way ahead best."""
