/* SPDX-License-Identifier: BSD-3-Clause */
/* [re, im] = fracfit_response(formula, parameters, omega) in Octave and MATLAB: mkoctfile --mex, mex. */
#include <fracfit.h>
#include <mex.h>

void mexFunction(int result_count, mxArray* results[], int argument_count, const mxArray* arguments[]) {
  if (argument_count != 3 || result_count != 2)
    mexErrMsgTxt("usage: [re, im] = fracfit_response(formula, parameters, omega)");
  char* formula = mxArrayToString(arguments[0]);
  fracfit_model* model = fracfit_model_create(formula);
  mxFree(formula);
  if (!model) mexErrMsgTxt(fracfit_error());
  const size_t count = mxGetNumberOfElements(arguments[2]);
  for (int i = 0; i < 2; ++i) results[i] = mxCreateDoubleMatrix(1, count, mxREAL);
  const int status = fracfit_model_response(model, mxGetPr(arguments[1]), mxGetNumberOfElements(arguments[1]),
                                            mxGetPr(arguments[2]), count, mxGetPr(results[0]), mxGetPr(results[1]));
  fracfit_model_destroy(model);
  if (status != FRACFIT_OK) mexErrMsgTxt(fracfit_error());
}
