% The oracle's ops (spec/oracle.md) in the language of MATLAB and Octave, for Octave 7 or later:
%
%     palpate-conform --profile f64 --require range -- octave-cli --norc adapter.m
%
% An op takes a struct of arguments, which were read and checked as all_ops says, and gives a struct; a list in it is a cell array.
source(fullfile(fileparts(mfilename("fullpath")), "oracle_lines.m"));

% ---- The normal law, thresholds and rates ----

function p = phi(x)
  p = erfc(-x / sqrt(2)) / 2;
end

% Octave's erfcinv is off by up to 1e-8 in the tail; a Newton step there leaves rounding alone.
function x = inverse_phi(p)
  q = min(p, 1 - p);
  x = -sqrt(2) * erfcinv(2 * q);
  tail = q < 0.1; y = x(tail);
  x(tail) -= (phi(y) - q(tail)) .* exp(y .^ 2 / 2) * sqrt(2 * pi);
  x(p > 0.5) *= -1;
end

function ok = normal_cdf(a)
  ok.p = phi(a.x);
end

function ok = normal_quantile(a)
  ok.x = inverse_phi(a.p);
end

function ok = two_afc(a)
  ok.p_correct = phi(a.gamma / sqrt(2));
end

function ok = gamma_from_two_afc(a)
  ok.gamma = sqrt(2) * inverse_phi(a.p_correct);
end

function ok = error_rates(a)
  if a.gamma == 0
    ok = struct("false_alarm", double(a.eta <= 0), "miss", double(a.eta > 0));
  else
    ok = struct("false_alarm", phi(-a.eta / a.gamma - a.gamma / 2), "miss", phi(a.eta / a.gamma - a.gamma / 2));
  end
end

function ok = roc(a)
  rate = a.false_alarm;
  refuse_if(any(rate < 0 | rate > 1), "out_of_range", "a rate is not between 0 and 1");
  ok.miss = num2cell(1 - rate); % the ends of the curve
  inner = rate > 0 & rate < 1;
  ok.miss(inner) = num2cell(phi(-inverse_phi(rate(inner)) - a.gamma));
  ok.auc = phi(a.gamma / sqrt(2));
end

function ok = required_gamma(a)
  ok.gamma = max(0, -inverse_phi(a.max_false_alarm) - inverse_phi(a.max_miss));
end

function ok = noise_budget(a)
  refuse_if(any(a.sources_n < 0), "out_of_range", "a source is below 0");
  ok = required_gamma(a);
  ok.total_allowed_n = a.signal_n / ok.gamma;
  used = norm(a.sources_n);
  ok.remaining_n = sqrt(max(0, ok.total_allowed_n - used) * (ok.total_allowed_n + used));
end

function ok = threshold_map(a)
  ok.eta = log((1 - a.prior_h1) / a.prior_h1);
end

function ok = threshold_bayes(a)
  refuse_if(a.c10 <= a.c00 || a.c01 <= a.c11, "out_of_range", "a wrong decision must cost more than a right one");
  ok.eta = log((1 - a.prior_h1) / a.prior_h1 * ((a.c10 - a.c00) / (a.c01 - a.c11)));
end

function ok = threshold_neyman_pearson_miss(a)
  ok.eta = a.gamma * (a.gamma / 2 + inverse_phi(a.max_miss));
end

function ok = threshold_neyman_pearson_false_alarm(a)
  ok.eta = -a.gamma * (a.gamma / 2 + inverse_phi(a.max_false_alarm));
end

% ---- The statistic ----

function ok = matched_filter(a)
  same_length(a.template_x, a.template_y);
  root = sqrt(numel(a.template_x)); x = norm(a.template_x); y = norm(a.template_y);
  ok = struct("b_x", x / root, "b_y", y / root, "sigma_x", a.noise_sd_x / root, "sigma_y", a.noise_sd_y / root);
  ok.gamma = hypot(x / a.noise_sd_x, y / a.noise_sd_y);
end

function [theta, y, gamma] = channel(observed, f0, f1, sd)
  same_length(observed, f0, f1);
  r = (observed - f0) / sd; d = (f1 - f0) / sd;
  theta = (r - d / 2)' * d; gamma = norm(d); y = 0;
  if gamma > 0, y = r' * (d / gamma) * sd / sqrt(numel(d)); end
end

function ok = theta(a)
  same_length(a.observed_x, a.observed_y);
  [x, ok.y_x, gamma_x] = channel(a.observed_x, a.f0_x, a.f1_x, a.noise_sd_x);
  [y, ok.y_y, gamma_y] = channel(a.observed_y, a.f0_y, a.f1_y, a.noise_sd_y);
  ok.theta = x + y; ok.gamma = hypot(gamma_x, gamma_y);
end

function ok = theta_colored(a)
  n = numel(a.residual); k = a.covariance;
  refuse_if(mod(n, 2), "bad_argument", "two channels have an even number of samples");
  refuse_if(numel(a.template) != n || any(size(k) != n), "bad_argument", "lengths differ");
  variances = diag(k);
  refuse_if(any(variances <= 0), "out_of_range", "a variance is not above 0");
  sd = sqrt(variances);
  refuse_if(any((abs(k - k') > 1e-12 * (sd * sd'))(:)), "out_of_range", "the covariance is not symmetric");
  [lower, failed] = chol(k, "lower");
  refuse_if(failed || any(diag(lower) .^ 2 <= 4 * (n + 2) * eps * variances), "out_of_range", "the covariance is not positive definite");
  r = lower \ a.residual; d = lower \ a.template;
  ok = struct("theta", (r - d / 2)' * d, "gamma", norm(d));
end

function ok = scan(a)
  same_length(a.residual_x, a.residual_y);
  same_length(a.template_x, a.template_y);
  refuse_if(numel(a.template_x) > numel(a.residual_x), "bad_argument", "the template is longer than the record");
  found = slide(a.residual_x, a.template_x, a.noise_sd_x) + slide(a.residual_y, a.template_y, a.noise_sd_y);
  [ok.max_theta, first] = max(found);
  ok.argmax = first - 1; ok.theta = num2cell(found);
end

function theta = slide(record, template, sd)
  r = record / sd; d = template / sd;
  theta = conv(r, flipud(d), "valid") - d' * d / 2;
end

% ---- Nuisances (spec/nuisance.md), the force table and counts ----

function v = beside(basis, v)
  for pass = 1:2, v -= basis * (basis' * v); end
end

function ok = theta_nuisances(a)
  n = numel(a.residual); known = strcmp(a.level, "known");
  refuse_if(!known && !strcmp(a.level, "unknown"), "out_of_range", "level is known or unknown");
  refuse_if(numel(a.template) != n || !isempty(a.nuisances) && columns(a.nuisances) != n, "bad_argument", "lengths differ");
  basis = zeros(n, 0);
  for signal = a.nuisances'
    left = beside(basis, signal / max(norm(signal), realmin));
    if norm(left) >= 1e-9, basis(:, end + 1) = left / norm(left); end
  end
  ok.rank = columns(basis); ok.degrees = nu = n - ok.rank - 1;
  z = beside(basis, a.residual); d = beside(basis, a.template); gamma = norm(d);
  refuse_if(nu < 1 || gamma <= 1e-9 * norm(a.template), "out_of_range", "too few samples, or no signal beside the nuisances");
  t = z' * d / gamma; ok.residual = norm(z - t * d / gamma) ^ 2; scale = 1;
  if !known, scale = sqrt(ok.residual / nu); end
  refuse_if(scale == 0, "out_of_range", "a record without noise tells nothing of its level");
  ok.t = t = t / scale; ok.gamma = gamma = gamma / scale; ok.gamma_nominal = norm(a.template);
  ratio = gamma * (2 * t - gamma); b = a.bias / scale;
  if known
    ok.theta = ratio / 2; tau = a.eta / gamma + gamma / 2; above = @(x) phi(-x);
  else
    ok.theta = (nu + 1) / 2 * log1p(ratio / (nu + (t - gamma) ^ 2));
    tau = least_t(a.eta, gamma, nu); above = @(x) student_upper(x, nu);
  end
  ok.false_alarm = above(tau - b); ok.miss = above(gamma - b - tau);
end

function t = least_t(eta, gamma, nu)
  over = expm1(2 * eta / (nu + 1)); energy = (over + 1) * gamma ^ 2; square = energy - nu * over ^ 2;
  if square >= 0, t = (energy + nu * over) / ((over + 1) * gamma + sqrt(square)); else, t = sign(eta) * Inf; end
end

function p = student_upper(x, nu)
  p = betainc(1 / (1 + x ^ 2 / nu), nu / 2, 1 / 2) / 2;
  if x < 0, p = 1 - p; end
end

function ok = interpolate(a)
  refuse_if(any(size(a.table_n) != [numel(a.depths_m), numel(a.laterals_m)]), "bad_argument", "the table does not fit its axes");
  [i, s] = locate(a.depths_m, a.depth_m); [j, t] = locate(a.laterals_m, a.lateral_m);
  ok.force_n = [1 - s, s] * a.table_n(i:i + 1, j:j + 1) * [1 - t; t];
end

function [cell, fraction] = locate(knots, x)
  cell = min(max(1, lookup(knots, x)), numel(knots) - 1);
  fraction = (x - knots(cell)) / (knots(cell + 1) - knots(cell));
end

% ---- All of them: a reader of oracle_lines.m, and the argument that it reads ----

function ops = all_ops()
  noise = "positive noise_sd_x positive noise_sd_y"; rates = "probability max_false_alarm probability max_miss";
  series = @(varargin) [sprintf("samples %s_x samples %s_y ", [varargin; varargin]{:}) noise];
  ops = struct("normal_cdf", "number x", "normal_quantile", "probability p", "two_afc", "not_negative gamma",
    "gamma_from_two_afc", "probability p_correct", "error_rates", "not_negative gamma number eta",
    "roc", "not_negative gamma samples false_alarm",
    "required_gamma", rates, "noise_budget", ["positive signal_n numbers sources_n " rates], "threshold", "",
    "matched_filter", series("template"), "theta", series("observed", "f0", "f1"), "scan", series("residual", "template"),
    "theta_colored", "samples residual samples template matrix covariance", "interpolate",
    "knots depths_m knots laterals_m matrix table_n number depth_m number lateral_m", "theta_nuisances",
    "samples residual samples template matrix nuisances word level not_negative bias number eta");
end

function readers = threshold_arguments(criterion)
  all = struct("map", "probability prior_h1", "bayes", "probability prior_h1 number c00 number c01 number c10 number c11",
    "neyman_pearson_miss", "not_negative gamma probability max_miss",
    "neyman_pearson_false_alarm", "positive gamma probability max_false_alarm");
  refuse_if(!ischar(criterion) || !isfield(all, criterion), "out_of_range", "no such criterion");
  readers = ["word criterion " all.(criterion)];
end

answer_lines();
