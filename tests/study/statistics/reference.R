# What R computes of the statistics. Reads cases from standard input, one a line: the function's name and its
# arguments, lists of numbers, between bars; writes the result's numbers, one line a case.
options(warn = 2) # an approximation that R warns of is no reference

signed_rank <- function(a, b) {
  test <- wilcox.test(a, b, paired = TRUE, exact = sum(a != b) <= 50, correct = FALSE)
  n <- sum(a != b)
  positive <- unname(test$statistic)
  c(n, sum(a == b), positive, n * (n + 1) / 2 - positive, test$p.value, n <= 50)
}

# The same with zeros or ties, of which wilcox.test makes an approximation: all 2^n choices of signs.
signed_rank_all_signs <- function(a, b) {
  d <- (a - b)[a != b]
  r <- rank(abs(d))
  sums <- as.matrix(expand.grid(rep(list(0:1), length(r)))) %*% r
  positive <- sum(r[d > 0])
  negative <- sum(r[d < 0])
  p <- min(1, 2 * mean(sums <= min(positive, negative)))
  c(length(r), sum(a == b), positive, negative, p, 1)
}

friedman <- function(...) {
  blocks <- rbind(...)
  n <- nrow(blocks)
  k <- ncol(blocks)
  test <- friedman.test(blocks)
  ranks <- t(apply(blocks, 1, rank))
  # Iman and Davenport's F is that of the two-way analysis of variance of the ranks.
  cells <- data.frame(rank = as.vector(ranks), treatment = gl(k, n), block = gl(n, 1, n * k))
  residual <- residuals(lm(rank ~ treatment + block, cells))
  if (all(abs(residual) < 1e-9)) {
    f <- c(Inf, 0)
  } else if (diff(range(colMeans(ranks))) == 0) {
    f <- c(0, 1)
  } else {
    variance <- anova(lm(rank ~ treatment + block, cells))
    f <- c(variance["treatment", "F value"], variance["treatment", "Pr(>F)"])
  }
  c(colMeans(ranks), test$statistic, test$parameter, test$p.value, f[1], k - 1, (k - 1) * (n - 1), f[2])
}

resampled_interval <- function(costs, reached, options) {
  n <- length(costs)
  level <- options[1]
  successes <- qbinom(c(1 + level, 1 - level) / 2, n, sum(reached) / n)
  ifelse(successes == 0, Inf, c(costs[reached == 1], 0)[1] + (n - successes) / successes * c(costs[reached == 0], 0)[1])
}

functions <- list(
  ranks = function(x) rank(x, ties.method = "average"),
  quantile = function(p, x) quantile(x, p, type = 7, names = FALSE),
  spread = function(x) quantile(x, c(0.5, 0.25, 0.75), type = 7, names = FALSE),
  signed_rank = function(a, b) {
    d <- (a - b)[a != b]
    exact <- length(d) <= 50
    if (exact && (anyDuplicated(abs(d)) || any(a == b))) signed_rank_all_signs(a, b) else signed_rank(a, b)
  },
  friedman = friedman,
  holm = function(p) p.adjust(p, "holm"),
  a12 = function(a, b) unname(wilcox.test(b, a, exact = FALSE)$statistic) / (length(a) * length(b)),
  kendall = function(a, b) cor(a, b, method = "kendall"),
  resampled_interval = resampled_interval,
  runtime_ecdf = function(costs, times) ecdf(times)(pmin(costs, .Machine$double.xmax))
)

for (line in readLines(file("stdin"))) {
  fields <- strsplit(line, "|", fixed = TRUE)[[1]]
  arguments <- lapply(fields[-1], function(field) as.numeric(strsplit(field, " ", fixed = TRUE)[[1]]))
  cat(sprintf("%.17g", do.call(functions[[fields[1]]], arguments)), "\n")
}
